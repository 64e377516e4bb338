#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/mesh/survey.h"

#include <cstddef>

namespace gs::qnv {

/// Returns the header of a surface, except for the sections of its payload.
[[nodiscard]] StreamHeader surface_header(Payload payload, const SurfaceSurvey& survey, const EncodeOptions& options);

/// Returns the maximum bytes of a base mesh that fits into the stream's first kilobyte with the rest of the header. If
/// metadata leaves less space, returns 500.
[[nodiscard]] std::size_t room_for_base(const StreamHeader& header);

}  // namespace gs::qnv
