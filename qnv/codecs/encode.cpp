#include "qnv/codecs/encode.h"

#include "qnv/codecs/shared/ranks.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

struct PayloadChoice {
  const PayloadRow* row;
  Suitability suits;
};

// Returns the payloads to try, in order: the requested one, then those that suit the source.
std::vector<PayloadChoice> choices(const EncodeSource& source, const EncodeRequest& request) {
  std::vector<PayloadChoice> all;
  for (const PayloadRow& row : payload_rows())
    if (!row.choose) {
      continue;
    } else if (row.payload == request.payload) {
      all.push_back({&row, {std::numeric_limits<int>::max(), "it was requested"}});
    } else if (const Suitability suits = row.choose(source, request); suits.rank > 0) {
      all.push_back({&row, suits});
    }
  std::ranges::stable_sort(all, std::ranges::greater{}, [](const PayloadChoice& one) { return one.suits.rank; });
  return all;
}

}  // namespace

std::variant<Encoding, EncodeError> encode(const EncodeSource& source, EncodeRequest request, Progress* progress) {
  EncodeOptions& options = request.options;
  const Payload wanted = request.payload.value_or(options.vectors > 0 ? Payload::packed : Payload::displaced);
  if (wanted != Payload::displaced) options.exact_bits = 0;
  options.only_if_suited = !request.payload && options.exact_bits <= 0;
  EncodeError unsuited{"no payload suits this source"};
  for (const auto& [row, suits] : choices(source, request)) {
    auto encoded = row->encode(source, options, progress);
    if (auto* stream = std::get_if<EncodedStream>(&encoded)) {
      if (options.ranks && options.ranks->rank() != 0) return Encoding{std::move(*stream), row, {}};
      const PayloadRow& chosen = row_of(stream->header);
      if (options.parity.value_or(0) > 0 && !stream->header.parity && !chosen.sniff)
        return EncodeError{"--parity protects displaced meshes, values and Gaussians; the payload is " +
                           std::string(chosen.name) + "; leave it out, or choose another --method"};
      std::string why(&chosen == row ? suits.why : "the surface has planes and sharp edges");
      return Encoding{std::move(*stream), &chosen, std::move(why)};
    }
    unsuited = std::move(std::get<EncodeError>(encoded));
    if (!unsuited.unsuited) break;
  }
  return unsuited;
}

bool uses_texture(const EncodeRequest& request, std::size_t triangles) {
  const EncodeOptions& options = request.options;
  if (request.payload.value_or(Payload::displaced) != Payload::displaced || options.vectors > 0) return false;
  return options.exact_bits > 0 || (options.exact_bits != 0 && triangles <= kMaxChosenTriangles);
}

}  // namespace gs::qnv
