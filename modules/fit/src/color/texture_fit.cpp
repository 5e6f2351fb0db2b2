// SPDX-License-Identifier: BSD-3-Clause
#include "color/texture_fit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim::detail {

namespace {

constexpr TextureConstants kTextures;

constexpr std::size_t kGroup = 128;      ///< successive points, enough to show noise
constexpr std::size_t kLookedAt = 1024;  ///< groups
constexpr double kQuietest = 0.1;        ///< share of groups that are taken for plain
/// Of chi squared over its mean: .455 where noise is grey, .789 where channels are independent.
constexpr double kMedianOfVariance = 0.5;

/** Colour of a polynomial at a place, 0..255. */
std::array<float, 3> colorAt(const ColorPolynomial& p, float u, float v) {
  std::array<float, 3> color;
  for (std::size_t c = 0; c < 3; ++c) {
    const float value =
        p[0][c] + u * (p[1][c] + u * p[3][c] + v * p[4][c]) + v * (p[2][c] + v * p[5][c]);
    color[c] = std::min(std::max(value, 0.0f), 255.0f);
  }
  return color;
}

/** The texels around a place, and their weights. */
struct Around {
  std::array<std::size_t, 4> at;
  std::array<float, 4> weight;

  Around(float x, float y, int side) {
    const auto last = static_cast<float>(side - 1), half = 0.5f * static_cast<float>(side);
    const float u = std::clamp(half * (x + 1) - 0.5f, 0.0f, last),
                v = std::clamp(half * (y + 1) - 0.5f, 0.0f, last);
    const int column = static_cast<int>(u), row = static_cast<int>(v);
    const float right = u - static_cast<float>(column), up = v - static_cast<float>(row);
    const int next = column + 1 < side ? 1 : 0, above = row + 1 < side ? side : 0;
    const int first = row * side + column;
    at = {static_cast<std::size_t>(first), static_cast<std::size_t>(first + next),
          static_cast<std::size_t>(first + above), static_cast<std::size_t>(first + above + next)};
    weight = {(1 - right) * (1 - up), right * (1 - up), (1 - right) * up, right * up};
  }

  std::array<float, 3> of(const std::vector<std::array<float, 3>>& colors) const {
    std::array<float, 3> sum{};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t c = 0; c < 3; ++c) sum[c] += weight[k] * colors[at[k]][c];
    return sum;
  }
};

constexpr float kScale = 1 / SurfelTexture::kReach;

/** The weight of a leaf's colours at one of its points. */
float weightAt(const SheetPoints& points, std::size_t i, float variance_weight) {
  const float s_sq =
      points.u[i] * points.u[i] + points.v[i] * points.v[i] + points.w[i] * points.w[i];
  return variance_weight * SurfelTexture::weight(s_sq, 0.0f);
}

}  // namespace

void raiseWeights(const SheetPoints& points, float variance_weight, LeadingWeights& weights) {
  for (std::size_t i = 0; i < points.count; ++i) {
    const float weight = weightAt(points, i, variance_weight);
    std::uint32_t bits;
    std::memcpy(&bits, &weight, sizeof bits);
    std::atomic<std::uint32_t>& leading = weights[points.index[i]];
    std::uint32_t known = leading.load(std::memory_order_relaxed);
    while (known < bits && !leading.compare_exchange_weak(known, bits, std::memory_order_relaxed)) {
    }
  }
}

/** Half the squared distance of colours of successive points, which are near each other, is their
 * noise's variance on average; its median in a group does without the edges of what is painted. */
double colorNoise(const PointStore& store, const ColorColumns& colors, const LabTable& lab) {
  std::vector<double> medians;
  const std::size_t groups = store.size() / kGroup,
                    step = std::max<std::size_t>(1, groups / kLookedAt);
  for (std::size_t g = 0; g < groups; g += step) {
    std::array<double, kGroup - 1> halves;
    float last[3] = {}, next[3];
    for (std::size_t k = 0; k < kGroup; ++k) {
      const std::size_t i = g * kGroup + k;
      lab.convert(colors[0][i], colors[1][i], colors[2][i], next);
      double sum = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const double difference = double{next[c]} - last[c];
        sum += 0.5 * difference * difference;
        last[c] = next[c];
      }
      if (k > 0) halves[k - 1] = sum;
    }
    std::nth_element(halves.begin(), halves.begin() + halves.size() / 2, halves.end());
    medians.push_back(halves[halves.size() / 2] / kMedianOfVariance);
  }
  if (medians.empty()) return 0;
  const auto at = medians.begin() +
                  static_cast<std::ptrdiff_t>(kQuietest * static_cast<double>(medians.size()));
  std::nth_element(medians.begin(), at, medians.end());
  return *at;
}

/** The linear map from red, green and blue to colours whose distances are Delta E about one colour,
 * and its inverse: Cholesky factors of the metric of CIELAB there. */
struct TextureFitter::Metric {
  std::array<std::array<float, 3>, 3> to{}, from{};

  Metric(const LabTable& lab, const std::array<float, 3>& mean) {
    constexpr int kStep = 4;
    double slopes[3][3], g[3][3], l[3][3] = {};
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint8_t low[3], high[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const int value = static_cast<int>(std::lround(mean[k])), step = k == c ? kStep : 0;
        low[k] = static_cast<std::uint8_t>(std::max(value - step, 0));
        high[k] = static_cast<std::uint8_t>(std::min(value + step, 255));
      }
      float below[3], above[3];
      lab.convert(low[0], low[1], low[2], below);
      lab.convert(high[0], high[1], high[2], above);
      for (std::size_t k = 0; k < 3; ++k)
        slopes[c][k] = (double{above[k]} - below[k]) / (high[c] - low[c]);
    }
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        g[a][b] =
            slopes[a][0] * slopes[b][0] + slopes[a][1] * slopes[b][1] + slopes[a][2] * slopes[b][2];
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        double rest = g[a][b];
        for (std::size_t k = 0; k < b; ++k) rest -= l[a][k] * l[b][k];
        l[a][b] = a == b ? std::sqrt(std::max(rest, 1e-6)) : rest / l[b][b];
      }
    }
    // Delta E^2 = |L^T d|^2.
    double inverse[3][3] = {};  // of L^T, upper triangular
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t a = c + 1; a-- > 0;) {
        double rest = a == c ? 1.0 : 0.0;
        for (std::size_t k = a + 1; k <= c; ++k) rest -= l[k][a] * inverse[k][c];
        inverse[a][c] = rest / l[a][a];
      }
    }
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) {
        to[a][b] = static_cast<float>(l[b][a]);
        from[a][b] = static_cast<float>(inverse[a][b]);
      }
    }
  }

  static Even times(const std::array<std::array<float, 3>, 3>& m, const std::array<float, 3>& d) {
    Even product;
    for (std::size_t a = 0; a < 3; ++a)
      product[a] = m[a][0] * d[0] + m[a][1] * d[1] + m[a][2] * d[2];
    return product;
  }
};

/** Takes the points of the disc at which this leaf's colours count, and what the polynomial leaves of
 * their colours. \return the number of all points of the disc */
std::size_t TextureFitter::takePoints(const SheetPoints& points, const ColorPolynomial& polynomial,
                                      float variance_weight) {
  places_.clear();
  values_.clear();
  std::array<double, 3> sum{};
  std::size_t inside = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const float x = kScale * points.u[i], y = kScale * points.v[i];
    if (x * x + y * y >= 1) continue;
    ++inside;
    if (variance_weight > 0) {
      const std::uint32_t bits = weights_[points.index[i]].load(std::memory_order_relaxed);
      float leading;
      std::memcpy(&leading, &bits, sizeof leading);
      if (weightAt(points, i, variance_weight) < kTextures.least_share * leading) continue;
    }
    Even rest = colorAt(polynomial, points.u[i], points.v[i]);
    for (std::size_t c = 0; c < 3; ++c) {
      const float own = colors_[c][points.index[i]];
      rest[c] = own - rest[c];
      sum[c] += own;
    }
    places_.push_back({x, y});
    values_.push_back(rest);
  }
  const auto count = static_cast<double>(std::max<std::size_t>(places_.size(), 1));
  for (std::size_t c = 0; c < 3; ++c) mean_[c] = static_cast<float>(sum[c] / count);
  return inside;
}

/** Whether the colours of points, whose squared deviations have a sum, vary by more than the
 * tolerance and their noise. */
bool TextureFitter::deviates(float count, double square) const {
  if (count < kTextures.least_points) return false;
  const double tolerance_sq = kTextures.tolerance * kTextures.tolerance;
  return square >
         count * (tolerance_sq + noise_ * (1 + kTextures.deviations / std::sqrt(count - 1)));
}

/** The sums over the cells of all levels, from side x side texels up to one cell. */
void TextureFitter::sumUp(int side) {
  num_levels_ = 1;
  for (int s = side; s > 1; s = (s + 1) / 2) ++num_levels_;
  if (levels_.size() < static_cast<std::size_t>(num_levels_))
    levels_.resize(static_cast<std::size_t>(num_levels_));
  levels_[0].side = side;
  levels_[0].cells.assign(static_cast<std::size_t>(side * side), {});
  const float half = 0.5f * static_cast<float>(side);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const int column = std::min(static_cast<int>(half * (places_[i][0] + 1)), side - 1),
              row = std::min(static_cast<int>(half * (places_[i][1] + 1)), side - 1);
    Cell& cell = levels_[0].cells[static_cast<std::size_t>(row * side + column)];
    const Even& value = values_[i];
    for (std::size_t c = 0; c < 3; ++c) cell.sum[c] += value[c];
    cell.square += value[0] * value[0] + value[1] * value[1] + value[2] * value[2];
    cell.count += 1;
  }
  for (int k = 1; k < num_levels_; ++k) {
    const Level& fine = levels_[static_cast<std::size_t>(k - 1)];
    Level& coarse = levels_[static_cast<std::size_t>(k)];
    coarse.side = (fine.side + 1) / 2;
    coarse.cells.assign(static_cast<std::size_t>(coarse.side * coarse.side), {});
    for (int row = 0; row < fine.side; ++row) {
      for (int column = 0; column < fine.side; ++column) {
        const Cell& part = fine.cells[static_cast<std::size_t>(row * fine.side + column)];
        Cell& whole = coarse.cells[static_cast<std::size_t>(row / 2 * coarse.side + column / 2)];
        for (std::size_t c = 0; c < 3; ++c) whole.sum[c] += part.sum[c];
        whole.square += part.square;
        whole.count += part.count;
      }
    }
  }
}

/** Colours all cells from one cell down: the mean of their points where the cell above is divided,
 * else interpolated from the level above. */
void TextureFitter::divide() {
  Level& top = levels_[static_cast<std::size_t>(num_levels_ - 1)];
  top.colors.assign(1, {});
  top.cells[0].divided = true;
  for (int k = num_levels_ - 1; k-- > 0;) {
    Level& coarse = levels_[static_cast<std::size_t>(k + 1)];
    Level& fine = levels_[static_cast<std::size_t>(k)];
    fine.colors.resize(fine.cells.size());
    const float to_coarse = 1.0f / static_cast<float>(coarse.side);
    for (int row = 0; row < fine.side; ++row) {
      for (int column = 0; column < fine.side; ++column) {
        const auto at = static_cast<std::size_t>(row * fine.side + column);
        Cell& cell = fine.cells[at];
        const Cell& above =
            coarse.cells[static_cast<std::size_t>(row / 2 * coarse.side + column / 2)];
        if (above.divided && cell.count > 0) {
          double square = cell.square;
          for (std::size_t c = 0; c < 3; ++c) {
            fine.colors[at][c] = cell.sum[c] / cell.count;
            square -= double{cell.sum[c]} * fine.colors[at][c];
          }
          cell.divided = deviates(cell.count, square);
          continue;
        }
        Around around((static_cast<float>(column) + 0.5f) * to_coarse - 1,
                      (static_cast<float>(row) + 0.5f) * to_coarse - 1, coarse.side);
        // Divided cells are mixtures of colours.
        float plain = 0;
        for (std::size_t n = 0; n < 4; ++n)
          plain += coarse.cells[around.at[n]].divided ? 0.0f : around.weight[n];
        for (std::size_t n = 0; n < 4 && plain > 0; ++n)
          around.weight[n] *= coarse.cells[around.at[n]].divided ? 0.0f : 1 / plain;
        fine.colors[at] = around.of(coarse.colors);
        cell.divided = false;
      }
    }
  }
}

/** Gives texels of divided cells without points the colour of the nearest of the texels about them that
 * have some: the mixture in the cell above would blur edges. */
void TextureFitter::fillGaps() {
  Level& texels = levels_[0];
  const Level& above = levels_[1];
  const int side = texels.side;
  const float half = 0.5f * static_cast<float>(side);
  middles_.assign(texels.cells.size(), {});
  for (const auto& place : places_) {
    const float x = half * (place[0] + 1), y = half * (place[1] + 1);
    const int column = std::min(static_cast<int>(x), side - 1),
              row = std::min(static_cast<int>(y), side - 1);
    auto& middle = middles_[static_cast<std::size_t>(row * side + column)];
    middle[0] += x;
    middle[1] += y;
  }
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const auto at = static_cast<std::size_t>(row * side + column);
      if (texels.cells[at].count > 0 ||
          !above.cells[static_cast<std::size_t>(row / 2 * above.side + column / 2)].divided)
        continue;
      float least = std::numeric_limits<float>::max();
      for (int k = 0; k < 9; ++k) {
        const int x = column + k % 3 - 1, y = row + k / 3 - 1;
        if (x < 0 || y < 0 || x >= side || y >= side) continue;
        const auto next = static_cast<std::size_t>(y * side + x);
        const float count = texels.cells[next].count;
        if (!(count > 0)) continue;
        const float dx = middles_[next][0] / count - static_cast<float>(column) - 0.5f,
                    dy = middles_[next][1] / count - static_cast<float>(row) - 0.5f;
        if (dx * dx + dy * dy >= least) continue;
        least = dx * dx + dy * dy;
        texels.colors[at] = texels.colors[next];
      }
    }
  }
}

/** Moves texels of divided cells by what interpolation leaves at the points around them. */
void TextureFitter::sharpen() {
  Level& texels = levels_[0];
  const Level& above = levels_[1];
  sums_.assign(texels.colors.size(), {});
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Around around(places_[i][0], places_[i][1], texels.side);
    const Even value = around.of(texels.colors);
    for (std::size_t k = 0; k < 4; ++k) {
      auto& sum = sums_[around.at[k]];
      for (std::size_t c = 0; c < 3; ++c) sum[c] += around.weight[k] * (values_[i][c] - value[c]);
      sum[3] += around.weight[k];
    }
  }
  for (int row = 0; row < texels.side; ++row) {
    for (int column = 0; column < texels.side; ++column) {
      const auto at = static_cast<std::size_t>(row * texels.side + column);
      const bool divided =
          above.cells[static_cast<std::size_t>(row / 2 * above.side + column / 2)].divided;
      const auto& sum = sums_[at];
      for (std::size_t c = 0; c < 3 && divided && sum[3] > 0; ++c)
        texels.colors[at][c] += kTextures.relaxation * sum[c] / sum[3];
    }
  }
}

/** Appends the finest level's colours. */
void TextureFitter::write(const ColorPolynomial& polynomial, const Metric& metric,
                          std::vector<std::uint8_t>& texels) const {
  const int side = levels_[0].side;
  const float texel = 2 * SurfelTexture::kReach / static_cast<float>(side);
  const auto middleOf = [&](int k) {
    return texel * (static_cast<float>(k) + 0.5f) - SurfelTexture::kReach;
  };
  // Where no points around count in this leaf, texels repeat others: these take next to nothing in files.
  const int depth = std::min(2, num_levels_ - 1);
  const Level& blocks = levels_[static_cast<std::size_t>(depth)];
  const auto isUsed = [&](int row, int column) {
    const int block = (row >> depth) * blocks.side + (column >> depth);
    return blocks.cells[static_cast<std::size_t>(block)].count > 0;
  };
  for (int k = 0; k < side * side; ++k) {
    const int row = k / side, column = k % side;
    if (k > 0 && !isUsed(row, column)) {
      const std::size_t from = texels.size() - 3 * static_cast<std::size_t>(column > 0 ? 1 : side);
      for (std::size_t c = 0; c < 3; ++c) texels.push_back(texels[from + c]);
      continue;
    }
    const auto base = colorAt(polynomial, middleOf(column), middleOf(row)),
               rest = Metric::times(metric.from, levels_[0].colors[static_cast<std::size_t>(k)]);
    for (std::size_t c = 0; c < 3; ++c)
      texels.push_back(
          static_cast<std::uint8_t>(std::lround(std::clamp(base[c] + rest[c], 0.0f, 255.0f))));
  }
}

int TextureFitter::fit(const SheetPoints& points, const std::uint8_t* color, float variance_weight,
                       std::vector<std::uint8_t>& texels) {
  const ColorPolynomial polynomial = decodeColor(color);
  const std::size_t inside = takePoints(points, polynomial, variance_weight);
  if (static_cast<float>(places_.size()) < kTextures.least_points) return 0;
  const Metric metric(lab_, mean_);
  double square = 0;
  for (Even& value : values_) {
    value = Metric::times(metric.to, value);
    square += value[0] * value[0] + value[1] * value[1] + value[2] * value[2];
  }
  if (!deviates(static_cast<float>(places_.size()), square)) return 0;
  const double spacing = std::sqrt(M_PI / static_cast<double>(inside));  // [reach]
  const int side =
      std::clamp(static_cast<int>(std::lround(2 / (kTextures.finest * spacing))), 2,
                 variance_weight > 0 ? SurfelTexture::kMostSide : kTextures.internal_side);
  sumUp(side);
  divide();
  fillGaps();
  for (int k = 0; k < kTextures.sharpenings; ++k) sharpen();
  write(polynomial, metric, texels);
  return side;
}

}  // namespace pcl_slim::detail
