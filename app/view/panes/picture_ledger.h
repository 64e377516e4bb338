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

/// Inputs that determine the picture of a viewport. Equal inputs give equal pictures, if both pictures are complete.
struct PictureSource {
  std::weak_ptr<const render::RenderList> list;  // render list of the view
  const render::RenderList* shown = nullptr;  // drawn list: that of the view or a copy with slices; only compared
  std::uint64_t changes = 0;  // number of changes of `shown` so far
  std::uint64_t grown = 0;  // number of changes of its streams and movies so far
  render::Camera camera;
  render::DrawOptions draw;  // window position and decode limit are set to 0, because they do not affect the picture
};
[[nodiscard]] bool are_same(const PictureSource& one, const PictureSource& other);

/// Inputs of the pictures on the screen, by viewport. With them, a viewport is only drawn again if its picture would
/// change.
class PictureLedger {
 public:
  /// Picture on the screen, with its inputs.
  struct Kept {
    PictureSource source;
    double seconds = 0;  // seconds that drawing took
    Refinement refinement;  // determines whether drawing again would add detail
  };

  /// Reports whether the picture on the screen has the same inputs as `source`. Call before drawing.
  [[nodiscard]] bool is_same(std::size_t viewport, const PictureSource& source) const;
  /// Reports whether the picture on the screen can stay, given equal inputs. `busy` means that the user is acting; then
  /// a picture that takes long to draw is not refined.
  [[nodiscard]] bool stands(std::size_t viewport, bool busy) const;
  /// Records the inputs of a picture that was drawn and is now on the screen.
  void note(std::size_t viewport, PictureSource source, const render::FrameStatistics& statistics, double seconds);
  /// Records that drawing was cancelled; the previous picture stays on the screen.
  void note_given_up(std::size_t viewport, const render::FrameStatistics& statistics);
  /// Reports whether drawing the viewport again would add detail to its picture.
  [[nodiscard]] bool wants_more(std::size_t viewport) const;

  static constexpr double kQuick = 0.03;  // seconds; a picture that takes longer is not refined while the user acts

 private:
  std::map<std::size_t, Kept> kept_;
};

}  // namespace gs::app
