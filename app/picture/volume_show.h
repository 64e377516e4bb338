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

/// Options for how a picture shows a volume.
struct VolumeWishes {
  std::string transfer;  // colour map or transfer function file; empty means the volume's own
  std::vector<SliceWish> slices;
  VolumeSlices slice_look;  // slice options other than which slices are shown, and where
  bool color_bar = false;
  [[nodiscard]] bool any() const { return !transfer.empty() || !slices.empty() || color_bar; }
};

/// Effects of VolumeWishes on one picture.
class VolumeShow {
 public:
  /// Prepares the picture; returns a message on failure. `path` is the file of the world, from which slices read
  /// values. `key` describes the values that surface colours stand for.
  [[nodiscard]] std::optional<std::string> prepare(const VolumeWishes& wishes, const std::string& path,
                                                   const render::RenderList& list, const std::optional<ColorKey>& key,
                                                   const WorldBudget& budget);
  /// Applies the options to the list, the splat style and the overlay of `scene`. This object must outlive `scene`.
  void apply(PictureScene& scene);

 private:
  VolumeWishes wishes_;
  std::optional<ColorBar> surface_bar_;
  Transfer transfer_;  // empty means the volumes' own
  VolumeSlices slices_;
  std::shared_ptr<const VolumeGrid> grid_;
  SliceScene slice_scene_;
};

/// Returns the transfer function for a colour map's or file's name, or a message if it is neither.
[[nodiscard]] std::variant<Transfer, std::string> named_transfer(const std::string& name,
                                                                 const qnv::Description& volume);
/// Returns the colour bar of a displayed volume: of its transfer function, or of its slices if only they are shown.
[[nodiscard]] ColorBar shown_color_bar(const qnv::Description& volume, const Transfer& transfer,
                                       const VolumeSlices& slices);
/// Returns the first volume of a list, or null.
[[nodiscard]] const qnv::Description* first_volume(const render::RenderList& list);

}  // namespace gs::app
