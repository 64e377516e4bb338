#pragma once

#include "app/picture/paint.h"
#include "app/view/values/color_bar.h"
#include "app/view/values/slice_scene.h"
#include "app/view/values/slices.h"
#include "app/view/values/transfer_editor.h"
#include "app/view/values/volume_grid.h"

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// How a picture is to show a volume.
struct VolumeWishes {
  std::string transfer;  // a colour map or a file of a transfer function; empty: its own
  std::vector<SliceWish> slices;
  VolumeSlices slice_look;  // but for which, and where
  bool color_bar = false;
  [[nodiscard]] bool any() const { return !transfer.empty() || !slices.empty() || color_bar; }
};

/// What of a picture follows from that.
class VolumeShow {
 public:
  /// `path`: of the world, where a volume's values are read for slices; `key`: what the colours of its surfaces stand
  /// for. What is wrong, if anything.
  [[nodiscard]] std::optional<std::string> prepare(const VolumeWishes& wishes, const std::string& path,
                                                   const render::RenderList& list, const std::optional<ColorKey>& key,
                                                   const WorldBudget& budget);
  /// Changes what the picture shows: its list, the look of clouds, what is drawn over it. This must outlive it.
  void apply(PictureScene& scene);

 private:
  VolumeWishes wishes_;
  std::optional<ColorBar> surface_bar_;
  Transfer transfer_;  // empty: their own
  VolumeSlices slices_;
  std::shared_ptr<const VolumeGrid> grid_;
  SliceScene slice_scene_;
};

/// The transfer function that a map or a file means for a volume; a message where it is neither.
[[nodiscard]] std::variant<Transfer, std::string> named_transfer(const std::string& name,
                                                                 const qnv::Description& volume);
/// Of what shows a volume: its transfer function, or the colours of its slices where they are alone.
[[nodiscard]] ColorBar shown_color_bar(const qnv::Description& volume, const Transfer& transfer,
                                       const VolumeSlices& slices);
/// The first volume of a list; null: it has none.
[[nodiscard]] const qnv::Description* first_volume(const render::RenderList& list);

}  // namespace gs::app
