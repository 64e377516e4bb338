#pragma once

#include "app/encode/mesh_stream.h"
#include "qnv/codecs/shared/gaussian_source.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace gs::app {

/// File of Gaussian splats that is read in pieces, so that it may exceed memory. The description has the metadata of an
/// import (vectors_of_splats()). One thread at a time.
struct SplatFile {
  qnv::GaussianSource source;
};

/// Opens a file with more than `more_than` splats if its type is read in ranges (ContentType::open_rows). Reads it
/// once. Returns nullopt for other files, and for splats that are discs of one opacity. The name of the file in `path`
/// tells its type if its bytes do not. `bytes` must outlive the result. Safe for untrusted input; the size of a piece
/// bounds the memory.
[[nodiscard]] std::optional<SplatFile> open_splat_file(std::string_view path, std::span<const std::byte> bytes,
                                                       const PutAside& put_aside = {});
[[nodiscard]] std::optional<SplatFile> open_splat_file(std::string_view path, std::span<const std::byte> bytes,
                                                       std::size_t more_than, const PutAside& put_aside = {});

}  // namespace gs::app
