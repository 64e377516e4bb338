#include "qnv/codecs/gaussians/encode/stream_plan.h"

#include "qnv/codecs/gaussians/splat_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

// Share of the Gaussians that are less important than those with the finest steps.
constexpr double kLessImportant = 0.6;
// Size of details that count as points, relative to MergeTree::detail().
constexpr double kPoint = 1.0 / 16;
// Maximum lattice steps along the longest edge of the box, so that codes of positions stay below their limit.
constexpr double kMostSteps = 1 << 21;

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Precision precision_of(const Gaussians& source, const Box& box, float detail) {
  Precision precision;
  precision.box = box;
  precision.version = GaussianCoding::Version::tuned;
  const glm::vec3 size = precision.box.size();
  const double edge = std::max({size.x, size.y, size.z});
  precision.finest = scale_code(std::max(detail * kPoint, edge / kMostSteps));
  std::vector<int> all(source.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::array<int, 3> scales{};
    for (std::size_t k = 0; k < 3; ++k) scales[k] = scale_code(source.scales[i][static_cast<int>(k)]);
    std::ranges::sort(scales, std::ranges::greater{});
    all[i] = importance(scales, opacity_code(source.opacities[i]), precision);
  }
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(kLessImportant * static_cast<double>(all.size() - 1));
  std::ranges::nth_element(all, middle);
  precision.important = std::clamp<int>(*middle, -32768, 32767);
  return precision;
}

}  // namespace

std::optional<EncodeError> problem_of(const Gaussians& splats, std::size_t first) {
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const glm::vec4& q = splats.rotations[i];
    if (!finite(splats.positions[i]) || !finite(splats.scales[i]) || !finite(splats.bases[i]) ||
        !std::isfinite(q.x + q.y + q.z + q.w) || !std::isfinite(splats.opacities[i]))
      return EncodeError{"Gaussian " + std::to_string(first + i) + " is not finite; expected finite numbers"};
  }
  return std::nullopt;
}

StreamPlan plan_of(const GaussianSource& source, const Gaussians& sample, const Box& box,
                   const EncodeOptions& options) {
  StreamPlan plan;
  plan.header.payload = Payload::gaussians;
  plan.header.description = source.base.description;
  plan.header.description.box.add(box.lower);
  plan.header.description.box.add(box.upper);
  add_metadata(options.metadata, plan.header.description);
  plan.header.colored = true;
  plan.header.color = source.base.color;
  plan.header.cube = Cube::around(plan.header.description.box);
  const Box& whole = source.base.description.box;
  plan.detail = detail_of(sample, whole.empty() ? box : whole);
  plan.precision = precision_of(sample, plan.header.description.box, plan.detail);
  plan.precision.steps = std::clamp(options.splat_steps, -GaussianCoding::kMostSteps, GaussianCoding::kMostSteps);
  plan.header.gaussians = {plan.precision.important, plan.precision.finest, plan.precision.steps, source.degree,
                           source.antialiased,       plan.precision.version};
  return plan;
}

bool encode_chunks(ClusterWork& work, std::vector<OpenRange> ranges, const MeanHarmonics& harmonics,
                   const EncodeOptions& options, ChunkRecords& records, std::vector<OpenCluster>* given,
                   Progress* progress) {
  std::size_t shown = 0, bytes = 0;
  bool good = true;
  const auto take = [&](EncodedCluster&& cluster) {
    std::vector<EncodedHarmonics> chunks;
    if (work.source.degree > 0)
      chunks = encode_harmonics(cluster, work.tree, harmonics, work.source.degree, work.precision);
    good = records.add(cluster, chunks, bounds_of(cluster.nodes, work.precision.box));
    shown += cluster.nodes.size() - (cluster.head.parent == ClusterHead::kNoParent ? 0 : cluster.replaced);
    bytes += cluster.bytes.size();
    // Further chunks would exceed the limits of the stream.
    return good && (options.vectors == 0 || shown < options.vectors) &&
           (options.max_bytes == 0 || bytes < options.max_bytes);
  };
  return encode_clusters(work, std::move(ranges), take, given, progress) && good;
}

std::variant<EncodedStream, EncodeError> write_chunks(StreamHeader header, std::vector<ChunkRecord> records,
                                                      const SharedStore& store, const EncodeOptions& options) {
  const Protection protection = options.parity ? equal_protection(options) : Protection{Protection::Kind::unequal};
  const OrderedChunks chunks(std::move(records), options.vectors, store);
  return write_together(std::move(header), chunks, options, protection);
}

}  // namespace gs::qnv::gaussians
