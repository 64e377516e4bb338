#pragma once

#include "app/confined/decoder_child.h"
#include "app/formats/common/asset.h"
#include "app/formats/common/content_type.h"

#include <cstddef>
#include <span>
#include <vector>

namespace gs::app {

/// Imports a file as `type.read` does: meshes, scenes (glTF), splats and points in a confined child (app/confined). The
/// child has no files; this process reads those that the file refers to. Local files of more than kMostLocalBytes are
/// read in this process, because copying their results takes too long. Volumes have a child of their own
/// (app/formats/volume/confined).
[[nodiscard]] Asset read_confined(const ContentType& type, const ImportSource& source);
inline constexpr std::size_t kMostLocalBytes = std::size_t{8} << 20;

/// Imports a file in a child: an ImportFile. `request` has the bytes of an ImportRequest.
[[nodiscard]] std::vector<std::byte> import_in_child(std::span<const std::byte> request,
                                                     std::span<const std::byte> file, const ReadFile& ask);

}  // namespace gs::app
