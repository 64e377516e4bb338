#pragma once

#include "app/formats/export/export.h"
#include "app/formats/export/volume_values_writer.h"

#include <optional>
#include <string>

namespace gs::app {

// Export the values of a volume (qnv::Volume::values) with the type of its source. Values that are not exact are
// rounded to that type. The values must have level 0. Each function returns a message if the geometry has no values.

// Writers of volumes. They pass the file to `take` in pieces, so that volumes may be larger than memory. They return a
// message on failure, and an empty message if `take` returns false.
using VolumeWriter = std::optional<std::string> (*)(const qnv::Geometry& geometry, const ExportOptions& options,
                                                    const TakeBytes& take);
[[nodiscard]] std::optional<std::string> write_nrrd(const qnv::Geometry& geometry, const ExportOptions& options,
                                                    const TakeBytes& take);
[[nodiscard]] std::optional<std::string> write_vti(const qnv::Geometry& geometry, const ExportOptions& options,
                                                   const TakeBytes& take);
[[nodiscard]] std::optional<std::string> write_nifti(const qnv::Geometry& geometry, const ExportOptions& options,
                                                     const TakeBytes& take);
[[nodiscard]] std::optional<std::string> write_nifti_gz(const qnv::Geometry& geometry, const ExportOptions& options,
                                                        const TakeBytes& take);
[[nodiscard]] std::optional<std::string> write_fits(const qnv::Geometry& geometry, const ExportOptions& options,
                                                    const TakeBytes& take);

/// Exports NRRD 4 (Teem), raw. Values with slope and intercept become float32, because NRRD has neither.
[[nodiscard]] Exported export_nrrd(const qnv::Geometry& geometry, const ExportOptions& options = {});
/// Exports VTK XML ImageData with raw appended data. Values with slope and intercept become float32. Refuses axes that
/// are not at right angles.
[[nodiscard]] Exported export_vti(const qnv::Geometry& geometry, const ExportOptions& options = {});
/// Exports NIfTI-1. Refuses more than 32767 voxels per axis.
[[nodiscard]] Exported export_nifti(const qnv::Geometry& geometry, const ExportOptions& options = {});
/// Exports NIfTI-1 compressed by gzip. Refuses more than 32767 voxels per axis.
[[nodiscard]] Exported export_nifti_gz(const qnv::Geometry& geometry, const ExportOptions& options = {});
/// Exports FITS 4.0. Unsigned integers are stored with an offset (4.4.2.5), missing voxels as BLANK or NaN. Axis
/// directions are lost.
[[nodiscard]] Exported export_fits(const qnv::Geometry& geometry, const ExportOptions& options = {});

}  // namespace gs::app
