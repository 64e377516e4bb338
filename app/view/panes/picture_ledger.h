#pragma once

#include "app/view/viewports.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

namespace gs::app {

/// All that a picture of a viewport is made of: two that are equal are the same picture, once it is whole.
struct PictureSource {
  std::weak_ptr<const render::RenderList> list;  // of the view
  const render::RenderList* shown = nullptr;     // what is drawn: that, or one like it with slices; only compared
  std::uint64_t changes = 0;                     // of the latter
  std::uint64_t grown = 0;                       // how often streams and movies that it holds have changed
  render::Camera camera;
  render::DrawOptions draw;  // without the place in the window, and how much may be decoded at a time
};
[[nodiscard]] bool are_same(const PictureSource& one, const PictureSource& other);

/// What the pictures on the screen were made of, by viewport, so that one that has not changed is not drawn again.
class PictureLedger {
 public:
  /// What is known of the picture of a viewport that is kept.
  struct Kept {
    PictureSource source;
    double seconds = 0;     // that it took
    Refinement refinement;  // whether it gets better when it is drawn again
  };

  /// Before a picture: whether the kept one is of the same.
  [[nodiscard]] bool is_same(std::size_t viewport, const PictureSource& source) const;
  /// Whether the kept one, of the same, is shown again. `busy`: somebody does something, and is not kept waiting for
  /// detail elsewhere.
  [[nodiscard]] bool stands(std::size_t viewport, bool busy) const;
  /// A picture was drawn and is kept.
  void note(std::size_t viewport, PictureSource source, const render::FrameStatistics& statistics, double seconds);
  /// One was given up: that before is on the screen still.
  void note_given_up(std::size_t viewport, const render::FrameStatistics& statistics);
  /// Drawn again, the picture of a viewport would be better.
  [[nodiscard]] bool wants_more(std::size_t viewport) const;

  static constexpr double kQuick = 0.03;  // seconds: a picture that is drawn though somebody does something elsewhere

 private:
  std::map<std::size_t, Kept> kept_;
};

}  // namespace gs::app
