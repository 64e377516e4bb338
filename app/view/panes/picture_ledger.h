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

/// All inputs of a viewport's picture: equal inputs give equal pictures, once complete.
struct PictureSource {
  std::weak_ptr<const render::RenderList> list;  // list of the view
  const render::RenderList* shown = nullptr;     // drawn list: `list` or a copy with slices; only compared
  std::uint64_t changes = 0;                     // change counter of `shown`
  std::uint64_t grown = 0;                       // change counter of its streams and movies
  render::Camera camera;
  render::DrawOptions draw;  // without window position and decode limit
};
[[nodiscard]] bool are_same(const PictureSource& one, const PictureSource& other);

/// Inputs of the pictures on screen, by viewport, so that unchanged pictures are not drawn again.
class PictureLedger {
 public:
  /// Record of a viewport's kept picture.
  struct Kept {
    PictureSource source;
    double seconds = 0;     // drawing time
    Refinement refinement;  // reports whether another frame improves it
  };

  /// Reports whether the kept picture was made from the same inputs. Call before drawing.
  [[nodiscard]] bool is_same(std::size_t viewport, const PictureSource& source) const;
  /// Reports whether to show the kept picture, of equal inputs, again. `busy` means that the user is interacting: slow
  /// refinements elsewhere must wait.
  [[nodiscard]] bool stands(std::size_t viewport, bool busy) const;
  /// Records that a picture was drawn and is kept.
  void note(std::size_t viewport, PictureSource source, const render::FrameStatistics& statistics, double seconds);
  /// Records that a picture was cancelled; the previous one stays on screen.
  void note_given_up(std::size_t viewport, const render::FrameStatistics& statistics);
  /// Reports whether drawing the viewport again would improve its picture.
  [[nodiscard]] bool wants_more(std::size_t viewport) const;

  static constexpr double kQuick = 0.03;  // seconds; faster pictures are refined even during interaction elsewhere

 private:
  std::map<std::size_t, Kept> kept_;
};

}  // namespace gs::app
