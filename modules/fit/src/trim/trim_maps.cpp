// SPDX-License-Identifier: BSD-3-Clause
#include "trim/trim_maps.h"

#include <algorithm>
#include <iterator>
#include <memory>

#include "pcl_slim/core/parallel.h"
#include "trim/trim_maker.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kLongChain = 8;  ///< leaves of a chain that need not all be looked at
constexpr std::size_t kRun = 64;  ///< surfels a thread takes at a time; no result depends on it

/** \brief The steps from a surface to its maps. */
class TrimStage {
 public:
  TrimStage(const PointStore& store, const FitSettings& settings, double hole_size, int threads,
            SLIMSurface& surface)
      : surface_(surface),
        threads_(threads),
        core_(settings.constants.trim.core),
        may_(surface.size())
  {
    for (std::size_t i = 0; i < surface.size(); ++i) may_[i] = surface.isLeaf(i);
    for (int t = 0; t < threads; ++t) {
      makers_.push_back(std::make_unique<TrimMaker>(store, settings, hole_size, surface));
    }
  }

  /** \brief Finds the leaves' gaps, and which of them are real. \return whether there is one. */
  bool findOpenLeaves()
  {
    const std::vector<LeafGaps> seeds = findReal();
    if (seeds.empty()) return false;
    gaps_ = findGaps(true);
    std::vector<std::uint8_t> real(joinChains(surface_, threads_, gaps_), 0);
    auto own = gaps_.begin();
    for (const LeafGaps& seed : seeds) {
      while (own->surfel < seed.surfel) ++own;
      for (const LeafGaps::Place& place : seed.ends) {
        const int gap = seed.real[place.gap] ? own->gapAt(place.u, place.v) : -1;
        if (gap >= 0) real[own->chain[static_cast<std::size_t>(gap)]] = 1;
      }
    }
    for (LeafGaps& gaps : gaps_) {
      for (std::size_t gap = 0; gap < gaps.count; ++gap) gaps.real[gap] = real[gaps.chain[gap]];
    }
    return true;
  }

  std::size_t makeMaps()
  {
    const std::vector<std::uint8_t> has_open = aboveOpenLeaves();
    std::vector<const LeafGaps*> of_surfel(surface_.size(), nullptr);
    for (const LeafGaps& gaps : gaps_) of_surfel[gaps.surfel] = &gaps;
    std::vector<std::uint8_t> sides(surface_.size());
    std::vector<std::vector<std::uint8_t>> runs((surface_.size() + kRun - 1) / kRun);
    forRuns(surface_.size(), [&](std::size_t i, std::size_t run, TrimMaker& maker) {
      if (!has_open[i]) return;
      sides[i] = static_cast<std::uint8_t>(maker.make(i, of_surfel[i], runs[run]));
    });
    std::vector<std::uint8_t> bits;
    for (const auto& run : runs) bits.insert(bits.end(), run.begin(), run.end());
    surface_.setTrimMaps(sides, bits);
    return static_cast<std::size_t>(std::count(has_open.begin(), has_open.end(), 1));
  }

 private:
  std::vector<LeafGaps> findGaps(bool with_folds)
  {
    std::vector<std::vector<LeafGaps>> runs((surface_.size() + kRun - 1) / kRun);
    forRuns(surface_.size(), [&](std::size_t i, std::size_t run, TrimMaker& maker) {
      if (!may_[i]) return;
      LeafGaps gaps = maker.findGaps(i, with_folds);
      may_[i] = maker.mayHaveGaps();
      if (gaps.count > 0) runs[run].push_back(std::move(gaps));
    });
    std::vector<LeafGaps> all;
    for (auto& run : runs) std::move(run.begin(), run.end(), std::back_inserter(all));
    return all;
  }

  /** Leaves with a gap that chance does not explain. Leaves of long chains are tried until one is found,
   * those of short ones each but once. */
  std::vector<LeafGaps> findReal()
  {
    std::vector<LeafGaps> leaves = findGaps(false);
    if (leaves.empty()) return leaves;
    std::vector<std::vector<std::uint32_t>> chains(joinChains(surface_, threads_, leaves));
    for (std::uint32_t k = 0; k < leaves.size(); ++k) {
      for (std::uint32_t gap = 0; gap < leaves[k].count; ++gap) {
        auto& chain = chains[leaves[k].chain[gap]];
        const bool inner = leaves[k].reachesIn(gap, core_);
        if (inner && (chain.empty() || chain.back() != k)) chain.push_back(k);
      }
    }
    std::vector<std::uint32_t> single;
    for (auto& chain : chains) {
      if (chain.size() >= kLongChain) continue;
      single.insert(single.end(), chain.begin(), chain.end());
      chain.clear();
    }
    std::sort(single.begin(), single.end());
    single.erase(std::unique(single.begin(), single.end()), single.end());
    for (const std::uint32_t k : single) chains.push_back({k});
    std::vector<std::vector<std::uint32_t>> real(chains.size());
    std::vector<std::uint32_t> found(chains.size());
    parallelFor(chains.size(), threads_, 1, [&](std::size_t chain, int thread) {
      TrimMaker& maker = *makers_[static_cast<std::size_t>(thread)];
      for (const std::uint32_t k : chains[chain]) {
        found[chain] = k;
        if (maker.findReal(leaves[k], real[chain])) break;
      }
    });
    for (std::size_t chain = 0; chain < chains.size(); ++chain) {
      for (const std::uint32_t gap : real[chain]) leaves[found[chain]].real[gap] = 1;
    }
    const auto chance = [](const LeafGaps& gaps) { return !gaps.hasReal(); };
    leaves.erase(std::remove_if(leaves.begin(), leaves.end(), chance), leaves.end());
    return leaves;
  }

  template <typename Body>
  void forRuns(std::size_t count, const Body& body)
  {
    parallelFor((count + kRun - 1) / kRun, threads_, 1, [&](std::size_t run, int thread) {
      const std::size_t end = std::min(count, (run + 1) * kRun);
      for (std::size_t i = run * kRun; i < end; ++i) {
        body(i, run, *makers_[static_cast<std::size_t>(thread)]);
      }
    });
  }

  /** Leaves with real gaps, and internal surfels above them: children are on finer levels. */
  std::vector<std::uint8_t> aboveOpenLeaves() const
  {
    std::vector<std::uint8_t> has_open(surface_.size(), 0);
    for (const LeafGaps& gaps : gaps_) has_open[gaps.surfel] = gaps.hasReal();
    for (std::size_t i = surface_.size(); i-- > 0;) {
      for (std::uint32_t k = surface_.child_begin[i]; k < surface_.child_begin[i + 1]; ++k) {
        has_open[i] |= has_open[surface_.children[k]];
      }
    }
    return has_open;
  }

  SLIMSurface& surface_;
  int threads_;
  double core_;  ///< [r] real gaps reach a leaf so far in
  std::vector<std::unique_ptr<TrimMaker>> makers_;
  std::vector<std::uint8_t> may_;  ///< surfels that may have gaps
  std::vector<LeafGaps> gaps_;     ///< of leaves that have some
};

}  // namespace

void
makeTrimMaps(const PointStore& store, const FitSettings& settings, double hole_size,
             FitStatistics& stats, SLIMSurface& surface)
{
  surface.dropTrimMaps();
  TrimStage stage(store, settings, hole_size, stats.threads, surface);
  if (!stage.findOpenLeaves()) return;
  stats.trim_candidates = stage.makeMaps();
}

}  // namespace pcl_slim::detail
