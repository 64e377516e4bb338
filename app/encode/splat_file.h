#pragma once

#include "app/encode/mesh_stream.h"
#include "base/box.h"
#include "qnv/codecs/shared/gaussian_source.h"
#include "qnv/codecs/shared/ranks.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {

/// File of Gaussian splats that is read in pieces, so that it may exceed memory. The description has the metadata of an
/// import (vectors_of_splats()). One thread at a time.
struct SplatFile {
  qnv::GaussianSource source;
};

/// Facts about all splats of a file.
struct SplatSurvey {
  /// Consecutive rows of the file. Ranks divide the runs among them.
  struct Run {
    std::uint64_t splats = 0;  // number of visible splats
    double area = 0;           // total area of their discs
  };
  std::vector<Run> runs;
  int degree = 0;
  bool antialiased = false, two_sided = false;
  WideBox box;
  std::vector<std::pair<std::string, std::string>> metadata;
};

/// Reads a file with more than `more_than` splats once, if its type is read in ranges (ContentType::open_rows). The
/// name in `path` tells the type if the bytes do not. Each rank reads its share. Returns nullopt for other files, and
/// if a rank cannot read its share; all ranks return equal results. Collective.
[[nodiscard]] std::optional<SplatSurvey> survey_splats(std::string_view path, std::span<const std::byte> bytes,
                                                       std::size_t more_than, const PutAside& put_aside,
                                                       qnv::Ranks& ranks);
/// Opens a file with more than `more_than` splats. `known` is its survey; if it is null, reads the file once. Returns
/// nullopt for other files, and for splats that are discs of one opacity. `bytes` must outlive the result. Safe for
/// untrusted input; the size of a run bounds the memory.
[[nodiscard]] std::optional<SplatFile> open_splat_file(std::string_view path, std::span<const std::byte> bytes,
                                                       std::size_t more_than, const PutAside& put_aside = {},
                                                       const SplatSurvey* known = nullptr);

}  // namespace gs::app
