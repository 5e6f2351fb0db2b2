// SPDX-License-Identifier: BSD-3-Clause
// Sorting of Morton keys with their places: our radix sort beside Highway's vectorised quicksort. All
// methods sort the same keys in turn, in one process, and must come to the same order. Ratios are to
// the radix sort's time, run by run; medians are shown.
#include <algorithm>
#include <cstdio>
#include <new>
#include <thread>

#include <hwy/contrib/sort/vqsort.h>

#include "common/options.h"
#include "measure/clocks.h"
#include "measure/lists.h"
#include "measure/scenes.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"

namespace {

using namespace pcl_slim;

using Keys = AlignedVector<std::uint64_t>;
using Order = AlignedVector<std::uint32_t>;

struct Settings {
  std::string points = "1000000,10000000", threads = "1,2", shape = "bumpy";
  int repeats = 5;

  std::vector<double> point_list, thread_list;
  std::vector<std::string> shape_list;
};

/** \brief What each method makes: keys ascending, and where each stood. */
struct Sorted {
  Keys keys;
  Order order;

  bool operator==(const Sorted& other) const
  {
    return std::equal(keys.begin(), keys.end(), other.keys.begin(), other.keys.end()) &&
           std::equal(order.begin(), order.end(), other.order.begin(), other.order.end());
  }
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("sort_bench", "1", "Times the radix sort of Morton keys beside vqsort.");
  options.text("points", &s.points, "N,...", "numbers of keys");
  options.text("threads", &s.threads, "N,...", "numbers of threads");
  options.text("shape", &s.shape, "NAME,...", "sphere, torus, bumpy, relief");
  options.integer("repeats", &s.repeats, 1, 100, "runs of each method; medians are shown");
  return options;
}

Error
finishOptions(Settings& s)
{
  if (Error error = measure::parseShapes(s.shape, s.shape_list)) return error;
  return measure::parseLists({{"points", &s.points, 100, 4e9, true, &s.point_list},
                              {"threads", &s.threads, 1, 4096, true, &s.thread_list}});
}

/** Codes of points of a shape in random order, scaled into the unit box as a point store does. */
Keys
makeKeys(const std::string& name, std::size_t count)
{
  measure::Shape shape;
  measure::parseShape(name, shape);
  const measure::Scene scene = measure::makeScene(shape, count, 0.001, 0, 7);
  const std::vector<double>& p = scene.points;
  const auto [low, high] = std::minmax_element(p.begin(), p.end());
  const double middle = 0.5 * (*low + *high), scale = 1.0 / (*high - *low);
  const auto local = [&](double x) { return (x - middle) * scale; };
  Keys keys(count);
  for (std::size_t i = 0; i < count; ++i) {
    keys[i] = mortonCode(local(p[3 * i]), local(p[3 * i + 1]), local(p[3 * i + 2]));
  }
  return keys;
}

/** vqsort of [begin, end). With several threads the middle of a sample parts the numbers in two,
 * each half of the threads sorting one. */
template <typename Number>
void
quickSort(Number* begin, Number* end, int threads)
{
  constexpr std::ptrdiff_t kSample = 1024;
  if (threads <= 1 || end - begin < 2 * kSample) {
    hwy::Sorter()(begin, static_cast<std::size_t>(end - begin), hwy::SortAscending());
    return;
  }
  std::vector<Number> sample;
  for (std::ptrdiff_t i = 0; i < kSample; ++i) sample.push_back(begin[(end - begin) / kSample * i]);
  std::nth_element(sample.begin(), sample.begin() + kSample / 2, sample.end());
  const Number pivot = sample[kSample / 2];
  Number* const middle = std::partition(begin, end, [&](const Number& n) { return n < pivot; });
  std::thread other([&] { quickSort(begin, middle, threads / 2); });
  quickSort(middle, end, threads - threads / 2);
  other.join();
}

template <typename Body>
void
forAll(std::size_t n, int threads, const Body& body)
{
  parallelFor(n, threads, 1 << 14, [&](std::size_t i, int) { body(i); });
}

/** Key and place as one number of 128 bits. */
void
sortPairs(Sorted& s, int threads)
{
  const std::size_t n = s.keys.size();
  AlignedVector<hwy::uint128_t> pairs(n);
  forAll(n, threads, [&](std::size_t i) {
    pairs[i].hi = s.keys[i];
    pairs[i].lo = i;
  });
  quickSort(pairs.data(), pairs.data() + n, threads);
  s.order.resize(n);
  forAll(n, threads, [&](std::size_t i) {
    s.keys[i] = pairs[i].hi;
    s.order[i] = static_cast<std::uint32_t>(pairs[i].lo);
  });
}

/** As sortByKey(), with vqsort in the radix sort's place: leading bits of the key and the place in
 * 64 bits; runs that share those bits are sorted afterwards. */
void
sortPacked(Sorted& s, int threads)
{
  const std::size_t n = s.keys.size();
  int place_bits = 1;
  while (n >> place_bits != 0) ++place_bits;
  const int low_bits = place_bits - 1;
  Keys numbers(n), sorted(n);
  forAll(n, threads, [&](std::size_t i) { numbers[i] = s.keys[i] >> low_bits << place_bits | i; });
  quickSort(numbers.data(), numbers.data() + n, threads);
  s.order.resize(n);
  forAll(n, threads, [&](std::size_t i) {
    s.order[i] = static_cast<std::uint32_t>(numbers[i] & ((std::uint64_t{1} << place_bits) - 1));
    sorted[i] = s.keys[s.order[i]];
  });
  for (std::size_t i = 0; i < n;) {
    std::size_t end = i + 1;
    while (end < n && sorted[end] >> low_bits == sorted[i] >> low_bits) ++end;
    std::sort(s.order.begin() + i, s.order.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
      return s.keys[a] != s.keys[b] ? s.keys[a] < s.keys[b] : a < b;
    });
    std::sort(sorted.begin() + i, sorted.begin() + end);
    i = end;
  }
  s.keys.swap(sorted);
}

/** \return whether every method made the same. */
bool
measureRow(const std::string& shape, const Keys& keys, int threads, int repeats)
{
  struct Method {
    const char* name;
    void (*sort)(Sorted&, int);
    std::vector<double> wall, cpu, wall_ratio, cpu_ratio;
  };
  Method methods[] = {
      {"radix", [](Sorted& s, int t) { sortByKey(s.keys, s.order, t); }, {}, {}, {}, {}},
      {"vqsort, 64 bits", sortPacked, {}, {}, {}, {}},
      {"vqsort, 128 bits", sortPairs, {}, {}, {}, {}},
  };
  Sorted expected;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    for (Method& method : methods) {
      Sorted sorted{keys, {}};
      const double wall = measure::wallSeconds(), cpu = measure::cpuSeconds();
      method.sort(sorted, threads);
      method.wall.push_back(measure::wallSeconds() - wall);
      method.cpu.push_back(measure::cpuSeconds() - cpu);
      method.wall_ratio.push_back(method.wall.back() / methods[0].wall.back());
      method.cpu_ratio.push_back(method.cpu.back() / methods[0].cpu.back());
      if (expected.keys.empty()) expected = sorted;
      if (sorted == expected) continue;
      std::fprintf(stderr, "sort_bench: %s came to another order\n", method.name);
      return false;
    }
  }
  for (const Method& method : methods) {
    const double nanoseconds = 1e9 / static_cast<double>(keys.size());
    std::printf("| %s | %zu | %d | %s | %.1f | %.2f | %.1f | %.2f |\n", shape.c_str(), keys.size(),
                threads, method.name, nanoseconds * measure::median(method.wall),
                measure::median(method.wall_ratio), nanoseconds * measure::median(method.cpu),
                measure::median(method.cpu_ratio));
  }
  std::fflush(stdout);
  return true;
}

bool
measureAll(const Settings& s)
{
  measure::keepFreedMemory();
  std::puts("| shape | keys | threads | method | ns/key wall | ratio | ns/key CPU | ratio |");
  std::puts("|---|---|---|---|---|---|---|---|");
  for (const std::string& shape : s.shape_list) {
    for (const double points : s.point_list) {
      const Keys keys = makeKeys(shape, static_cast<std::size_t>(points));
      for (const double threads : s.thread_list) {
        if (!measureRow(shape, keys, static_cast<int>(threads), s.repeats)) return false;
      }
    }
  }
  return true;
}

}  // namespace

int
main(int argc, char** argv)
try {
  Settings settings;
  OptionTable options = declareOptions(settings);
  if (const auto status = options.parse(argc, argv)) return *status;
  if (Error error = finishOptions(settings)) {
    std::fprintf(stderr, "sort_bench: %s\n", error.message.c_str());
    return kExitUsage;
  }
  return measureAll(settings) ? kExitDone : kExitFailed;
} catch (const std::bad_alloc&) {
  std::fputs("sort_bench: not enough memory; give smaller -points\n", stderr);
  return kExitFailed;
}
