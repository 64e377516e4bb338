#include "qnv/sampling/order/order_spread.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gs::qnv::order {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Gaps of points that are already taken. They are lower than all distances.
constexpr float kJustTaken = -1, kTaken = -2;
constexpr unsigned kSteps = 4;  // number of steps per halving of the distance
constexpr std::size_t kExactWork = std::size_t{1} << 25;  // maximum number of distances that the exact method computes
constexpr std::size_t kExactWhole = 4096;  // maximum number of points for which the whole order is exact
constexpr std::size_t kRestPart = 4;  // after 1/kRestPart of the points, the rest is sorted by its current distances
constexpr std::uint32_t kRestSteps = 12;
constexpr std::size_t kParallel = 2000;  // minimum number of cells for which several threads pay
constexpr std::size_t kCellsPerTask = 128;
constexpr unsigned kBlockLevels = 3;  // log2 of a block's edge in cells; a surface's block fits into the cache

// Returns the squared distance of a step: the square of 2^(-step/4).
float squared_distance(std::uint32_t step) {
  const float whole = std::ldexp(1.0f, -static_cast<int>(step / 2));
  return step % 2 == 0 ? whole : whole * 0.70710678f;
}

// Candidates of one octave: points that are far enough from the taken points. Contains all such points, or one such
// point per cell of a finer level.
struct Candidates {
  Points points;
  std::vector<std::uint32_t> of_tree;  // index of each candidate in the tree
  std::vector<float> gaps;  // squared distance to the nearest taken point, times density; kJustTaken or
                                       // kTaken for taken points
  [[nodiscard]] std::size_t size() const { return of_tree.size(); }
  void resize(std::size_t count) {
    points.resize(count);
    of_tree.resize(count);
    gaps.assign(count, kInfinity);
  }
};

// Taken points, sorted by cell.
struct Centres {
  std::vector<Centre> centres;
  std::vector<std::uint32_t> first;  // first point of each cell; one more entry for the end
};

Centre centre_of(const Points& p, std::size_t i) { return {p.x[i], p.y[i], p.z[i], p.nx[i], p.ny[i], p.nz[i]}; }

std::size_t largest(const std::vector<float>& gaps) {
  // Compares floats as integers: floats >= 0 keep their order, and negative floats are lower.
  std::int32_t most = std::numeric_limits<std::int32_t>::min();
  for (const float gap : gaps) most = std::max(most, std::bit_cast<std::int32_t>(gap));
  return static_cast<std::size_t>(std::find(gaps.begin(), gaps.end(), std::bit_cast<float>(most)) - gaps.begin());
}

class Spreader {
 public:
  Spreader(Tree& tree, const SpreadOptions& options)
      : tree_(tree),
        options_(options),
        points_(tree.points),
        relax_(has_relax_avx2() ? relax_avx2 : relax_portable),
        // Candidate cells have 1/8 of the octave's initial distance. In a volume, candidate cells have 1/4, which gives
        // about as many cells.
        depth_(options.surface ? 3 : 2),
        is_taken_(tree.points.size() / 64 + 1) {
    if (options.surface) find_densities();
  }

  std::vector<Taken> run() {
    const std::size_t count = tree_.source.size();
    taken_.reserve(count);
    unsigned level = 0;
    while (!takes_all(level) && exact_work(level + 1) <= kExactWork) ++level;
    neighbours_ = neighbours_of_root();
    for (unsigned l = 1; l <= level; ++l) neighbours_ = neighbours_below(tree_, l, neighbours_, options_.threads);
    find_candidates(level, 0);
    take_furthest(level);
    while (taken_.size() < count / kRestPart && is_below(level) && !cancelled()) {
      neighbours_ = neighbours_below(tree_, ++level, neighbours_, options_.threads);
      run_octave(level);
    }
    if (!cancelled()) take_rest(level);
    return std::move(taken_);
  }

 private:
  [[nodiscard]] bool cancelled() const { return options_.progress && options_.progress->cancelled; }
  [[nodiscard]] bool is_below(unsigned level) const { return level + 1 < tree_.levels.size(); }
  [[nodiscard]] bool takes_all(unsigned level) const { return level + depth_ + 1 >= tree_.levels.size(); }
  [[nodiscard]] std::size_t candidate_count(unsigned level) const {
    return takes_all(level) ? tree_.source.size() : tree_.levels[level + depth_].size();
  }
  // Returns the number of distances to compute if candidates are taken one by one, farthest first, to the end of a
  // level's octave. About as many candidates are taken as the next level has cells.
  [[nodiscard]] std::size_t exact_work(unsigned level) const {
    const std::size_t next = std::min<std::size_t>(level + 1, tree_.levels.size() - 1);
    return candidate_count(level) * tree_.levels[next].size();
  }
  [[nodiscard]] unsigned threads(unsigned level) const {
    return tree_.levels[level].size() >= kParallel ? options_.threads : 1;
  }
  [[nodiscard]] bool is_taken(std::size_t point) const { return is_taken_[point / 64] >> point % 64 & 1; }

  // Increases the density where normals vary within cells of about 1/4096 of the object. 1 - |mean normal| of a bent
  // piece is approximately (angle / 2)^2 / 2. A quarter of a right angle gives the maximum density.
  void find_densities() {
    const std::size_t wanted = std::min<std::size_t>(4096, tree_.source.size() / 8);
    unsigned level = 0;
    while (is_below(level) && tree_.levels[level].size() < wanted) ++level;
    const Level& cells = tree_.levels[level];
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      double x = 0, y = 0, z = 0;
      for (std::size_t i = cells.begin[cell]; i < cells.begin[cell + 1]; ++i)
        x += points_.nx[i], y += points_.ny[i], z += points_.nz[i];
      const double mean = std::sqrt(x * x + y * y + z * z) / (cells.begin[cell + 1] - cells.begin[cell]);
      const double variation = std::isfinite(mean) ? std::clamp(1 - mean, 0.0, 1.0) : 0;
      const auto density = static_cast<float>(1 + 2 * std::min(1.0, variation * 20));
      for (std::size_t i = cells.begin[cell]; i < cells.begin[cell + 1]; ++i) points_.density[i] = density;
    }
  }

  void take(std::uint32_t point, std::uint32_t step) {
    taken_.push_back({point, step});
    is_taken_[point / 64] |= std::uint64_t{1} << point % 64;
  }

  [[nodiscard]] Centres find_centres(unsigned level) const {
    const Level& cells = tree_.levels[level];
    Centres result;
    result.centres.reserve(taken_.size());
    result.first.reserve(cells.size() + 1);
    for (std::size_t word = 0; word < is_taken_.size(); ++word) {
      for (std::uint64_t bits = is_taken_[word]; bits != 0; bits &= bits - 1) {
        const std::size_t point = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
        while (cells.begin[result.first.size()] <= point || result.first.empty())
          result.first.push_back(static_cast<std::uint32_t>(result.centres.size()));
        result.centres.push_back(centre_of(points_, point));
      }
    }
    result.first.resize(cells.size() + 1, static_cast<std::uint32_t>(result.centres.size()));
    return result;
  }

  // Lists the candidates of one cell, without taken points: all points, or a random point per cell some levels below.
  void list_candidates(unsigned level, std::size_t cell, Candidates& list) const {
    list.of_tree.clear();
    if (takes_all(level)) {
      for (std::uint32_t i = tree_.levels[level].begin[cell]; i < tree_.levels[level].begin[cell + 1]; ++i)
        if (!is_taken(i)) list.of_tree.push_back(i);
    } else {
      const Level& below = tree_.levels[level + depth_];
      const std::size_t end = descendant(level, cell + 1, level + depth_);
      for (std::size_t i = descendant(level, cell, level + depth_); i < end; ++i) {
        const std::uint64_t lot = hash(options_.seed * 0x9e3779b97f4a7c15ULL + below.begin[i]);
        const auto point = below.begin[i] + static_cast<std::uint32_t>(lot % (below.begin[i + 1] - below.begin[i]));
        if (!is_taken(point)) list.of_tree.push_back(point);
      }
    }
    list.resize(list.of_tree.size());
    for (std::size_t i = 0; i < list.size(); ++i) list.points.copy(i, points_, list.of_tree[i]);
  }

  // Returns the first cell of level `below` that is inside a cell of `level`.
  [[nodiscard]] std::size_t descendant(unsigned level, std::size_t cell, unsigned below) const {
    for (; level < below; ++level) cell = tree_.levels[level].first_child[cell];
    return cell;
  }

  // Finds the candidates with gaps of at least `least`.
  void find_candidates(unsigned level, float least) {
    const Centres centres = find_centres(level);
    const std::size_t cells = tree_.levels[level].size();
    struct Part {
      std::vector<std::uint32_t> of_tree;
      std::vector<float> gaps;
    };
    std::vector<Part> parts((cells + kCellsPerTask - 1) / kCellsPerTask);
    first_.assign(cells + 1, 0);
    const auto find = [&](std::size_t part) {
      Candidates list;
      for (std::size_t cell = part * kCellsPerTask; cell < std::min(cells, (part + 1) * kCellsPerTask); ++cell) {
        list_candidates(level, cell, list);
        for (const std::uint32_t near : neighbours_.of(cell))
          for (std::uint32_t i = centres.first[near]; i < centres.first[near + 1]; ++i)
            relax_(list.points, 0, list.size(), centres.centres[i], options_.surface, list.gaps.data());
        for (std::size_t i = 0; i < list.size(); ++i) {
          if (list.gaps[i] < least) continue;
          parts[part].of_tree.push_back(list.of_tree[i]);
          parts[part].gaps.push_back(list.gaps[i]);
          ++first_[cell + 1];
        }
      }
    };
    parallel_for(parts.size(), find, threads(level));
    for (std::size_t cell = 0; cell < cells; ++cell) first_[cell + 1] += first_[cell];
    candidates_.resize(first_[cells]);
    const auto join = [&](std::size_t part) {
      std::size_t at = first_[part * kCellsPerTask];
      for (std::size_t i = 0; i < parts[part].of_tree.size(); ++i, ++at) {
        candidates_.of_tree[at] = parts[part].of_tree[i];
        candidates_.gaps[at] = parts[part].gaps[i];
        candidates_.points.copy(at, points_, parts[part].of_tree[i]);
      }
    };
    parallel_for(parts.size(), join, threads(level));
  }

  // Takes candidates one by one: always the candidate that is farthest from the taken points.
  void take_furthest(unsigned level) {
    const std::uint32_t last_step = kSteps * (level + 1);
    const bool whole = takes_all(level) && candidates_.size() <= kExactWhole;
    const float least = whole ? 0 : squared_distance(last_step);
    std::vector<float>& gaps = candidates_.gaps;
    std::uint32_t step = 0;
    for (std::size_t furthest = hash(options_.seed) % gaps.size(); !cancelled();) {
      while (step < last_step && gaps[furthest] < squared_distance(step)) ++step;
      take(candidates_.of_tree[furthest], step);
      relax_(candidates_.points, 0, gaps.size(), centre_of(candidates_.points, furthest), options_.surface,
             gaps.data());
      gaps[furthest] = kTaken;
      furthest = largest(gaps);
      if (gaps[furthest] < least) return;
    }
  }

  // Takes points for one octave of distances, from 2^-level down to half of that.
  void run_octave(unsigned level) {
    find_candidates(level, squared_distance(kSteps * (level + 1)));
    const unsigned block_level = level > kBlockLevels ? level - kBlockLevels : 0;
    std::array<std::vector<std::uint32_t>, 8> colors;
    for (std::size_t block = 0; block < tree_.levels[block_level].size(); ++block)
      colors[block_level == 0 ? 0 : tree_.octant(block_level, block)].push_back(static_cast<std::uint32_t>(block));
    for (unsigned i = 1; i <= kSteps && !cancelled(); ++i) {
      const std::uint32_t step = kSteps * level + i;
      // Processes the blocks in eight groups, like the colours of a chess board in 3D. Taking points in a block does
      // not change gaps in other blocks of the same group. Therefore threads may share a group, with the same result.
      for (const auto& color : colors) {
        parallel_for(
            color.size(), [&](std::size_t b) { sweep(level, block_level, color[b], squared_distance(step)); },
            threads(level));
      }
      collect(step);
      if (taken_.size() >= tree_.source.size() / kRestPart) return;
    }
  }

  // Takes all candidates of a block that are far enough from all points taken before.
  void sweep(unsigned level, unsigned block_level, std::size_t block, float least) {
    const std::size_t end = descendant(block_level, block + 1, level);
    for (std::size_t cell = descendant(block_level, block, level); cell < end; ++cell) {
      for (std::size_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        if (candidates_.gaps[i] < least) continue;
        candidates_.gaps[i] = kJustTaken;
        const Centre centre = centre_of(candidates_.points, i);
        for (const std::uint32_t near : neighbours_.of(cell))
          relax_(candidates_.points, first_[near], first_[near + 1], centre, options_.surface, candidates_.gaps.data());
      }
    }
  }

  void collect(std::uint32_t step) {
    std::vector<std::uint32_t> found;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (candidates_.gaps[i] != kJustTaken) continue;
      candidates_.gaps[i] = kTaken;
      found.push_back(candidates_.of_tree[i]);
    }
    take_spread(found, step);
  }

  // Takes the candidates of a list in an order in which every prefix is spread over the list. The list is in Morton
  // order.
  void take_spread(const std::vector<std::uint32_t>& found, std::uint32_t step) {
    GoldenStride stride(found.size(), options_.seed + step);
    for (std::size_t i = 0; i < found.size(); ++i) take(found[stride.next()], step);
  }

  // Takes all remaining points: those farthest from the taken points first.
  void take_rest(unsigned level) {
    if (taken_.size() == tree_.source.size()) return;
    const std::uint32_t first_step = taken_.empty() ? 0 : taken_.back().step + 1;
    std::vector<std::vector<std::uint32_t>> found(kRestSteps);
    if (takes_all(level)) {
      find_candidates(level, 0);
    } else {
      candidates_.resize(0);
      for (std::size_t i = 0; i < tree_.source.size(); ++i)
        if (!is_taken(i)) found.back().push_back(static_cast<std::uint32_t>(i));
    }
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      std::uint32_t step = 0;
      while (step + 1 < kRestSteps && candidates_.gaps[i] < squared_distance(first_step + step)) ++step;
      found[step].push_back(candidates_.of_tree[i]);
    }
    for (std::uint32_t step = 0; step < kRestSteps; ++step) take_spread(found[step], first_step + step);
  }

  const Tree& tree_;
  const SpreadOptions options_;
  Points& points_;
  const Relax relax_;
  const unsigned depth_;  // number of levels between an octave and its candidates
  std::vector<std::uint64_t> is_taken_;
  std::vector<Taken> taken_;
  Neighbours neighbours_;  // neighbours at the octave's level
  Candidates candidates_;
  std::vector<std::uint32_t> first_;  // first candidate of each cell of the octave's level; one more entry for the end
};

}  // namespace

std::vector<Taken> spread(Tree& tree, const SpreadOptions& options) {
  if (tree.source.empty()) return {};
  return Spreader(tree, options).run();
}

}  // namespace gs::qnv::order
