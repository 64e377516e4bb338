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

}  // namespace gs::app
