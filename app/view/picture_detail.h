#pragma once

#include <array>
#include <cstddef>

namespace gs::app {

/// Quality of a picture of a viewport.
struct PictureQuality {
  bool one_sample;   // no anti-aliasing
  float coarseness;  // divisor of the resolution along each axis
  friend bool operator==(const PictureQuality&, const PictureQuality&) = default;
};

/// Choice of the quality of a viewport's pictures while they change, so that slow machines draw them fluently. Pictures
/// at rest have full quality. Omits anti-aliasing and details of Gaussians first, then draws fewer Gaussians. Then
/// reduces the resolution in small steps, by more than a half only if input cancels pictures. All times are in seconds.
class PictureDetail {
 public:
  static constexpr double kGoal = 1.0 / 15;  // max time of a frame with a picture that changes
  static constexpr double kRestGoal = 0.25;  // time of the first frame at rest, unless drawing alone takes longer
  static constexpr double kLongestFadingPicture = 0.08;  // max seconds; slower pictures are too few for a fade
  /// Bounds and first value of the maximum number of Gaussians.
  static constexpr std::size_t kFewestGaussians = 80'000, kMostGaussians = 2'500'000, kFirstGaussians = 300'000;
  static constexpr std::array<PictureQuality, 10> kQualities{{{false, 1},
                                                              {true, 1},
                                                              {true, 1.15f},
                                                              {true, 1.33f},
                                                              {true, 1.5f},
                                                              {true, 1.75f},
                                                              {true, 2},
                                                              {true, 2.8f},
                                                              {true, 4},
                                                              {true, 8}}};

  /// Returns the accepted error of Gaussians at a level, in pixels of the reduced resolution. Coarser levels must save
  /// time, but errors below ten pixels leave most Gaussians in the picture.
  [[nodiscard]] static constexpr float splat_error(std::size_t level) { return level == 0 ? 1.0f : 16.0f; }

  /// Returns the level of quality of the next picture: an index into kQualities. `changing` means that the next picture
  /// differs from the last one.
  [[nodiscard]] std::size_t level(bool changing) const { return changing ? level_ : 0; }
  /// Returns the maximum number of Gaussians of the next picture at a level; 0 means unlimited.
  [[nodiscard]] std::size_t most_gaussians(std::size_t level) const { return level == 0 ? 0 : most_gaussians_; }
  /// Reports whether changes of Gaussians fade in the next picture at a level. Slow pictures at rest do not fade, so
  /// that the first one is complete.
  [[nodiscard]] bool fades(std::size_t level) const { return level > 0 || rest_seconds_ < kLongestFadingPicture; }
  /// Returns the amount to decode for the next picture, as a multiple of the amount for a changing picture. `rests`
  /// counts the pictures of a view at rest, including the next one; 0 means that the next picture changes.
  [[nodiscard]] std::size_t decoded_amounts(unsigned rests) const;
  /// Records that the frame of a picture at `level` took `seconds`, or that user input cancelled it. The picture had
  /// `gaussians` Gaussians. `other_seconds` is the part of the frame for Scripts, other pictures and the interface. If
  /// that part leaves less than 40 % of the goal, the picture may still take 40 % of it.
  void note(std::size_t level, bool given_up, double seconds, std::size_t gaussians = 0, double other_seconds = 0);

 private:
  void choose(std::size_t level);
  void learn(std::size_t gaussians);
  [[nodiscard]] bool draw_fewer(std::size_t level, std::size_t gaussians);
  [[nodiscard]] double goal() const;

  std::size_t level_ = 0;
  std::size_t most_gaussians_ = kFirstGaussians;
  int pictures_ = 0;        // pictures at the current level and with the current number of Gaussians
  int excess_ = 0;          // consecutive pictures with far more Gaussians than the maximum
  double mean_ = 0;         // mean time of the frames of `pictures_`; recent ones count more
  double other_ = 0;        // mean part of mean_ for Scripts, other pictures and the interface
  std::size_t former_ = 0;  // level before the last change; equal to level_ if the change is already measured
  double former_mean_ = 0;
  double rest_seconds_ = 0;  // time of the last frame at level 0; a cancelled one can only increase it
  int resting_ = 0;          // pictures until a coarser level may be chosen again, because the last one saved no time
  /// measured ratio of the times of the next finer level and of this level; 0 if unknown
  std::array<double, kQualities.size()> growth_{};
};

/// Time limit for pictures while a world loads, so that its progress stays visible. A picture that exceeds the limit is
/// cancelled. Then drawing pauses for as long as that picture took, and the limit doubles. All times are in seconds.
class LoadingPace {
 public:
  static constexpr double kFirst = 0.5, kMax = 8;

  /// Reports whether to continue drawing a picture that was begun at time `begin`.
  [[nodiscard]] bool go_on(double begin, double now) const { return begin >= rests_until_ && now - begin < patience_; }
  /// Records that a picture was drawn from `begin` to `now`; `given_up` means that it was cancelled.
  void note(bool given_up, double begin, double now) {
    if (begin < rests_until_) return;
    if (!given_up) {
      patience_ = kFirst;
    } else if (now - begin >= patience_) {
      rests_until_ = now + (now - begin);
      patience_ = patience_ * 2 > kMax ? kMax : patience_ * 2;
    }
  }

 private:
  double patience_ = kFirst, rests_until_ = 0;
};

}  // namespace gs::app
