#pragma once

namespace gs::app {

/// How coarsely a viewport is drawn while the viewer moves, so that he sees whole pictures soon enough on a machine
/// that is too slow for all pixels. A plain value.
class PictureDetail {
 public:
  static constexpr int kMost = 8;

  /// For the next picture: so many times fewer pixels each way. `changing`: it is not the same as the last one.
  [[nodiscard]] int coarseness(bool changing) const { return changing ? coarseness_ : 1; }
  /// A picture of this coarseness took `seconds`, or was given up for what the user did meanwhile.
  void note(int coarseness, bool given_up, double seconds) {
    if (given_up)
      coarseness_ = coarseness < coarseness_ ? coarseness_ : coarseness * 2 > kMost ? kMost : coarseness * 2;
    else if (coarseness == coarseness_ && coarseness > 1 && seconds * kCostOfHalf < kSoon)
      coarseness_ /= 2;
  }

 private:
  static constexpr double kCostOfHalf = 4;  // of half as coarse a picture, at the most
  static constexpr double kSoon = 0.2;      // seconds

  int coarseness_ = 1;
};

/// How long pictures may take while a world is read, whose progress is to be seen meanwhile: one that takes longer is
/// given up, and for as long as it took none is tried; then the next may take longer. A plain value, of seconds.
class LoadingPace {
 public:
  static constexpr double kFirst = 0.5, kMost = 8;

  /// Whether a picture that was begun at `begin` is gone on with.
  [[nodiscard]] bool go_on(double begin, double now) const { return begin >= rests_until_ && now - begin < patience_; }
  /// A picture was drawn, or given up, from `begin` to `now`.
  void note(bool given_up, double begin, double now) {
    if (begin < rests_until_) return;
    if (!given_up) {
      patience_ = kFirst;
    } else if (now - begin >= patience_) {
      rests_until_ = now + (now - begin);
      patience_ = patience_ * 2 > kMost ? kMost : patience_ * 2;
    }
  }

 private:
  double patience_ = kFirst, rests_until_ = 0;
};

}  // namespace gs::app
