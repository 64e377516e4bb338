#pragma once

#include "render/volume/volume_model.h"
#include "render/volume/volume_raster.h"

#include <span>

namespace gs::test {

/// Rasterizes all vectors of one volume. Returns an empty layer if its arrays have different lengths.
inline render::VolumeLayer rasterize_volume(const qnv::Volume& volume, const render::SplatView& view,
                                            const render::VolumeOptions& options = {}) {
  const render::VolumeModel model = render::volume_model(volume, view.threads);
  if (model.spacing.size() != volume.size()) return {};
  const render::VolumeItem item{&volume, &model, view.camera_from_node, volume.size(), options};
  return render::rasterize_volumes(std::span(&item, 1), view);
}

}  // namespace gs::test
