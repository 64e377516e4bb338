#pragma once

#include "app/commands/common/open_input.h"
#include "app/commands/common/option_groups.h"
#include "app/commands/common/progress_bar.h"
#include "app/encode/outline_model.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

namespace gs::app {

/// Returns the orientation of the output: that of the options, else that of the input.
[[nodiscard]] Upright wanted_upright(const ConversionOptions& options, const OpenedInput& input);

/// Outputs of an encoder that need no memory; see the members of qnv::EncodeOptions.
struct EncodeOutput {
  qnv::SpillStore* spill = nullptr;
  qnv::StreamSink* sink = nullptr;
  qnv::Ranks* ranks = nullptr;
  unsigned threads = 0;
};

/// Reports whether several ranks can share the work of encode_input(): the values of a volume, a mesh or a grid that
/// exceeds memory, or splats that are read in pieces.
[[nodiscard]] bool shares_work(const ConversionOptions& options, const OpenedInput& input);

/// Encodes an input (qnv::encode) with the settings of the options. Only values of volumes and Gaussian splats use the
/// sink of `output`; other streams have their bytes in memory.
[[nodiscard]] std::variant<qnv::EncodedStream, qnv::EncodeError> encode_input(const ConversionOptions& options,
                                                                              const OpenedInput& input,
                                                                              ProgressBar& progress,
                                                                              const EncodeOutput& output = {});

/// Returns the triangles of an input as a mesh, without the losses of a stream. Returns nullopt if it has none.
[[nodiscard]] std::optional<std::variant<qnv::Geometry, qnv::EncodeError>> mesh_of_input(
    const ConversionOptions& options, const OpenedInput& input, ProgressBar& progress);

/// Bytes per triangle while outline groups are made.
inline constexpr std::uint64_t kOutlineTriangleBytes = 400;

/// Returns the isosurface of a volume as polygons, or an error message.
[[nodiscard]] std::variant<OutlineModel, std::string> isosurface_outlines(const ConversionOptions& options,
                                                                          const qnv::VolumeSource& volume,
                                                                          ProgressBar& progress);

/// Returns the vectors of an input. If it has none, takes the gradients of a volume, or encodes the surface.
[[nodiscard]] std::variant<qnv::Geometry, qnv::EncodeError> geometry_of_input(const ConversionOptions& options,
                                                                              OpenedInput input, ProgressBar& progress);

}  // namespace gs::app
