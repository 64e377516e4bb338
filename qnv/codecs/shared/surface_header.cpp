#include "qnv/codecs/shared/surface_header.h"

#include <algorithm>

namespace gs::qnv {
namespace {

constexpr std::size_t kFirstBytes = 990, kMinBaseBytes = 500;

}  // namespace

StreamHeader surface_header(Payload payload, const SurfaceSurvey& survey, const EncodeOptions& options) {
  StreamHeader header;
  header.payload = payload;
  header.colored = survey.colored;
  header.color = survey.mean_color();
  header.cube = Cube::around(survey.box);
  header.description.two_sided = options.two_sided && !survey.closed();
  header.description.origin = options.origin;
  header.description.box = survey.box;
  header.description.total = survey.area;
  header.description.metadata = options.metadata;
  return header;
}

std::size_t room_for_base(const StreamHeader& header) {
  return kFirstBytes - std::min(encode_header(header).size(), kFirstBytes - kMinBaseBytes);
}

}  // namespace gs::qnv
