#include "qnv/codecs/gaussians/encode/gaussians_stream.h"

#include "qnv/codecs/gaussians/encode/parted_encoder.h"
#include "qnv/codecs/gaussians/encode/stream_plan.h"
#include "qnv/codecs/gaussians/encode/visibility.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace gaussians {
namespace {

// Maximum number of splats in a part of a large scene.
constexpr std::size_t kPart = 250'000;

/// Returns an error if a stream cannot have these splats.
std::optional<EncodeError> refusal_of(const GaussianSource& source) {
  if (source.count == 0) return EncodeError{"the source has no Gaussians; expected at least one"};
  if (source.degree < 0 || source.degree > Gaussians::kMaxDegree)
    return EncodeError{"the spherical harmonics have degree " + std::to_string(source.degree) + "; expected 0 to 3"};
  if (source.count > std::numeric_limits<std::uint32_t>::max() / 4)
    return EncodeError{"there are " + std::to_string(source.count) + " Gaussians; expected at most 2^30"};
  return std::nullopt;
}

std::variant<EncodedStream, EncodeError> encode_whole(const GaussianSource& source, const Gaussians& splats,
                                                      const EncodeOptions& options, Progress* progress) {
  if (auto problem = problem_of(splats)) return std::move(*problem);
  Box box;
  for (const glm::vec3& p : splats.positions) box.add(p);
  StreamPlan plan = plan_of(source, splats, box, options);
  const Box& own = source.base.description.box;
  const std::vector<float> visibility = visibility_of(splats, options.threads, progress);
  if (visibility.empty()) return EncodeError{"cancelled"};
  const auto tree = MergeTree::join(leaves_of(splats, own.empty() ? box : own, plan.detail, visibility), plan.detail, 1,
                                    options.threads, progress);
  if (!tree) return EncodeError{"cancelled"};
  MemoryStore memory;
  SharedStore store(options.spill ? *options.spill : memory);
  ChunkRecords records(store, 0);
  const FitStart start{{}, source.antialiased, options.vectors};
  const auto fitted = options.fitted ? fit_nodes(*tree, start, options.threads, progress) : FittedNodes();
  if (!fitted) return EncodeError{"cancelled"};
  ClusterWork work{splats, *tree, plan.precision};
  work.fitted = &*fitted;
  if (!encode_chunks(work, {}, MeanHarmonics(*tree, splats), options, records, nullptr, progress))
    return EncodeError{is_cancelled(progress) ? "cancelled" : store.problem()};
  std::vector<ChunkRecord> all;
  std::vector<std::uint32_t> clusters;
  records.append_to(all, clusters);
  return write_chunks(std::move(plan.header), std::move(all), store, options);
}

}  // namespace
}  // namespace gaussians

std::variant<EncodedStream, EncodeError> encode_gaussians(const GaussianSource& source, const EncodeOptions& options,
                                                          Progress* progress) {
  using namespace gaussians;
  if (auto problem = refusal_of(source)) return std::move(*problem);
  const std::size_t most = options.part_splats;
  if (source.count > (most ? most : kMostWholeGaussians))
    return encode_in_parts(source, most ? most : kPart, options, progress);
  Gaussians all;
  all.degree = source.degree;
  const bool read = source.read([&](const Gaussians& splats) {
    all.positions.insert(all.positions.end(), splats.positions.begin(), splats.positions.end());
    all.scales.insert(all.scales.end(), splats.scales.begin(), splats.scales.end());
    all.rotations.insert(all.rotations.end(), splats.rotations.begin(), splats.rotations.end());
    all.opacities.insert(all.opacities.end(), splats.opacities.begin(), splats.opacities.end());
    all.bases.insert(all.bases.end(), splats.bases.begin(), splats.bases.end());
    all.harmonics.insert(all.harmonics.end(), splats.harmonics.begin(), splats.harmonics.end());
    return !is_cancelled(progress);
  });
  if (!read) return EncodeError{is_cancelled(progress) ? "cancelled" : "cannot read the splats"};
  if (all.empty()) return EncodeError{"the source has no Gaussians; expected at least one"};
  return encode_whole(source, all, options, progress);
}

std::variant<EncodedStream, EncodeError> encode_gaussians(const Gaussians& source, const EncodeOptions& options,
                                                          Progress* progress) {
  using namespace gaussians;
  GaussianSource pieces{source, source.degree, source.antialiased, source.size(),
                        [&](const std::function<bool(const Gaussians&)>& take) { return take(source); }};
  if (auto problem = refusal_of(pieces)) return std::move(*problem);
  if (source.size() > (options.part_splats ? options.part_splats : kMostWholeGaussians))
    return encode_gaussians(pieces, options, progress);
  return encode_whole(pieces, source, options, progress);
}

}  // namespace gs::qnv
