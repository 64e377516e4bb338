#pragma once

#include "base/budget.h"
#include "base/noncopyable.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace gs::render {

/// View of a viewport that draws Gaussians.
struct GaussianMotion {
  qnv::LodView view;
  float coarseness = 1;              // factor that the error of `view` includes; above 1 while the view moves
  double time = 0;                   // time of the viewport's clock, in seconds
  bool fades = true;                 // if false, changes are immediate
  std::shared_ptr<Budget> budget{};  // of the world, for the levels; null means no limit
};

/// Levels of detail for Gaussians that are in memory as a whole. A thread encodes them as a stream. While a view moves,
/// a cut of this stream replaces them. At rest, the cut first becomes fine; then the Gaussians replace it. One thread,
/// apart from the encoding.
class GaussianLevels : NonCopyable {
 public:
  /// Minimum and maximum number of Gaussians that get levels.
  static constexpr std::size_t kLeast = 50'000, kMost = 2'000'000;

  /// `steady` applies to Gaussians that replaced others. Without a motion, they get levels only after this time.
  explicit GaussianLevels(std::size_t least = kLeast,
                          std::chrono::milliseconds steady = std::chrono::milliseconds(2000))
      : least_(least), steady_(steady) {}
  ~GaussianLevels();

  /// Returns the runs to draw for a view, or null if all Gaussians must be drawn. Starts to encode them if `eager`, or
  /// if the view moves, unless the budget refuses the memory for levels. Later calls then try again. Sets `pending` if
  /// the next picture of the view will differ. The runs are valid until the next call.
  [[nodiscard]] const std::vector<qnv::SplatRun>* cut(const std::shared_ptr<const qnv::Gaussians>& gaussians,
                                                      const GaussianMotion& motion, bool eager, bool& pending);
  /// Reports whether a thread encodes Gaussians.
  [[nodiscard]] bool working() const;
  /// Frees the levels of Gaussians that have no other owners. Call it once per frame.
  void forget_unused();

 private:
  struct Work;
  /// State of a viewport in which a cut replaces the Gaussians.
  struct Shown {
    bool moves = false;
    double rests_since = 0;  // valid if it does not move
  };
  struct Entry {
    std::shared_ptr<Work> work;            // null until the thread starts
    std::map<std::uint32_t, Shown> shown;  // by viewport
  };
  void start(const std::shared_ptr<const qnv::Gaussians>& gaussians, const GaussianMotion& motion, Entry& entry);

  std::size_t least_;
  std::chrono::milliseconds steady_;
  std::map<std::weak_ptr<const qnv::Gaussians>, Entry, std::owner_less<>> entries_;
  bool changing_ = false;  // the last Gaussians were replaced before their levels were complete
};

}  // namespace gs::render
