#pragma once

namespace gs::app {

/// Adaptive coarseness of a viewport during movement, so that slow machines still show complete pictures in time. A
/// plain value.
class PictureDetail {
 public:
  static constexpr int kMax = 8;

  /// Returns the divisor of the resolution per axis for the next picture. `changing` means that it differs from the
  /// last one.
  [[nodiscard]] int coarseness(bool changing) const { return changing ? coarseness_ : 1; }
  /// Records that a picture of this coarseness took `seconds`, or was cancelled because of user input.
  void note(int coarseness, bool given_up, double seconds) {
    if (given_up)
      coarseness_ = coarseness < coarseness_ ? coarseness_ : coarseness * 2 > kMax ? kMax : coarseness * 2;
    else if (coarseness == coarseness_ && coarseness > 1 && seconds * kCostOfHalf < kSoon)
      coarseness_ /= 2;
  }

 private:
  static constexpr double kCostOfHalf = 4;  // max cost ratio when coarseness halves
  static constexpr double kSoon = 0.2;      // seconds

  int coarseness_ = 1;
};

/// Time limit for pictures while a world loads, so that the progress stays visible. A picture over the limit is
/// cancelled, and drawing pauses for as long as it took; then the limit doubles. A plain value; all times in seconds.
class LoadingPace {
 public:
  static constexpr double kFirst = 0.5, kMax = 8;

  /// Reports whether to continue a picture that was begun at `begin`.
  [[nodiscard]] bool go_on(double begin, double now) const { return begin >= rests_until_ && now - begin < patience_; }
  /// Records a picture drawn or cancelled between `begin` and `now`.
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
