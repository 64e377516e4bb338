#pragma once

namespace gs::app {

/// Reduction of a viewport's resolution during movement, so that slow machines also complete their pictures in time.
class PictureDetail {
 public:
  static constexpr int kMax = 8;

  /// Returns the divisor of the resolution along each axis for the next picture. `changing` means that the next picture
  /// differs from the last one.
  [[nodiscard]] int coarseness(bool changing) const { return changing ? coarseness_ : 1; }
  /// Records that a picture with this coarseness took `seconds`, or was cancelled because of user input.
  void note(int coarseness, bool given_up, double seconds) {
    if (given_up)
      coarseness_ = coarseness < coarseness_ ? coarseness_ : coarseness * 2 > kMax ? kMax : coarseness * 2;
    else if (coarseness == coarseness_ && coarseness > 1 && seconds * kCostOfHalf < kSoon)
      coarseness_ /= 2;
  }

 private:
  static constexpr double kCostOfHalf = 4;  // max increase of the drawing time when the coarseness is halved
  static constexpr double kSoon = 0.2;  // seconds; the coarseness is only halved if pictures then take less

  int coarseness_ = 1;
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
