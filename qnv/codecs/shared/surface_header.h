#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/mesh/survey.h"

#include <cstddef>

namespace gs::qnv {

/// Returns the header of a surface, without the sections of its payload.
[[nodiscard]] StreamHeader surface_header(Payload payload, const SurfaceSurvey& survey, const EncodeOptions& options);

/// Returns the maximum bytes of a base, so that it fits into the stream's first kilobyte with the rest of the header.
/// If metadata takes too much of it, the base still gets 500 bytes.
[[nodiscard]] std::size_t room_for_base(const StreamHeader& header);

}  // namespace gs::qnv
