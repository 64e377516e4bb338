#include "qnv/codecs/octree/lod/lod_chunks.h"

#include "qnv/codecs/octree/packed_layout.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv {
namespace {

// Number of chunks that are read to test whether the directory is wrong.
constexpr std::size_t kSamples = 8;
constexpr std::size_t kBytesPerRead = std::size_t{1} << 18;

NormalCone cone_of(const PackedVoxels& voxels) {
  std::vector<glm::vec3> normals(voxels.size());
  glm::vec3 sum(0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if ((voxels.state[i] & kDouble) != 0) return {};
    const auto m = octahedral_normal(voxels.u[i], voxels.v[i]);
    normals[i] =
        glm::normalize(glm::vec3(static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2])));
    sum += normals[i];
  }
  NormalCone cone;
  const float length = std::sqrt(glm::dot(sum, sum));
  if (!(length > 0.1f * static_cast<float>(normals.size()))) return cone;
  cone.axis = sum / length;
  cone.cosine = 1;
  for (const glm::vec3& normal : normals) cone.cosine = std::min(cone.cosine, glm::dot(cone.axis, normal));
  return cone;
}

// Reports whether the box that a directory claims contains the cells. Tolerates one voxel edge, because splats extend
// beyond their voxels.
bool holds(const Box& claimed, const Box& cells, float edge, const Box& stream) {
  for (int i = 0; i < 3; ++i) {
    // Clips to the stream's box, because the directory cannot describe positions outside.
    const float low = std::max(cells.lower[i], stream.lower[i]), high = std::min(cells.upper[i], stream.upper[i]);
    if (low < claimed.lower[i] - edge || high > claimed.upper[i] + edge) return false;
  }
  return true;
}

}  // namespace

Box box_of_run(const PackedVoxels& voxels, int level, std::size_t first, std::size_t count, const Cube& cube) {
  glm::vec3 low(65536.0f), high(0);
  for (std::size_t i = first; i < first + count; ++i) {
    const glm::vec3 cell(voxels.x[i], voxels.y[i], voxels.z[i]);
    low = {std::min(low.x, cell.x), std::min(low.y, cell.y), std::min(low.z, cell.z)};
    high = {std::max(high.x, cell.x), std::max(high.y, cell.y), std::max(high.z, cell.z)};
  }
  const float edge = cube.edge / static_cast<float>(1 << level);
  Box box;
  box.lower = cube.lower + low * edge;
  box.upper = cube.lower + (high + 1.0f) * edge;
  return box;
}

LodChunks::Opened LodChunks::make(std::variant<StreamHeader, StreamProblem> read) {
  if (auto* problem = std::get_if<StreamProblem>(&read)) return std::move(*problem);
  StreamHeader& header = std::get<StreamHeader>(read);
  if (header.payload != Payload::packed)
    return StreamProblem{11, "a records stream has no levels of detail; expected a packed stream"};
  if (header.meshed) return StreamProblem{20, "the exact mesh replaces the levels of detail"};
  return LodChunks(std::move(header));
}

LodChunks::Opened LodChunks::open(std::shared_ptr<const ChunkSource> source, bool trust_directory) {
  std::size_t header_bytes = 0;
  Opened opened = make(read_stream_header(*source, header_bytes));
  auto* chunks = std::get_if<LodChunks>(&opened);
  if (!chunks) return opened;
  chunks->source_ = std::move(source);
  if (trust_directory)
    chunks->read_directory_of_source();
  else
    chunks->scan();
  if (chunks->tree_.root() == kNoNode) return StreamProblem{header_bytes, "has no root cluster"};
  return opened;
}

// Reads the directory. If the directory is incomplete or wrong, reads all chunks instead.
void LodChunks::read_directory_of_source() {
  const std::vector<DirectoryEntry> entries = read_directory(*source_, header_);
  const std::size_t senseless = tree_.set_directory(entries, source_->size());
  if (tree_.root() == kNoNode || !directory_fits()) {
    if (!entries.empty())
      problem(header_.directory, "the directory does not match the chunks; all chunks were read instead");
    tree_ = {};
    scan();
  } else if (senseless > 0) {
    problem(header_.directory, std::to_string(senseless) + " invalid entries of the directory are left out");
  }
}

LodChunks::Opened LodChunks::begin(std::span<const std::byte> front) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  Opened opened = make(decode_header(front, header_bytes, need_more));
  if (auto* chunks = std::get_if<LodChunks>(&opened)) {
    chunks->arrived_ = std::make_shared<ArrivedChunks>(LodLimits{}.arrived_bytes);
    chunks->source_ = chunks->arrived_;
    (void)chunks->push(front);
  }
  return opened;
}

// Reports whether the directory belongs to this stream: in a sample, the cluster identifiers and parents must match the
// chunks.
bool LodChunks::directory_fits() const {
  std::vector<std::byte> buffer;
  const auto fits = [&](std::uint32_t index) {
    const LodNode& node = tree_[index];
    if (node.broken) return true;
    const auto chunk = read_chunk(*source_, node.offset, node.bytes, buffer);
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    if (!sound) return true;  // damaged chunk; says nothing about the directory
    const auto header = read_cluster_header(sound->payload);
    const auto* cluster = std::get_if<ClusterHeader>(&header);
    return sound->type == ChunkType::packed && cluster && tree_.misfit(index, *cluster).empty();
  };
  for (std::size_t i = 0; i < tree_.size(); i += std::max<std::size_t>(1, tree_.size() / kSamples))
    if (!fits(static_cast<std::uint32_t>(i))) return false;
  // Requires the first cluster, which every view needs: a wrong directory must not lose it.
  return decode(tree_.root(), nullptr).cluster != nullptr;
}

// Reads the whole stream once, checks all checksums, and collects all chunks.
void LodChunks::scan() {
  const StreamReader::OnChunk arrive = [this](ChunkType type, std::span<const std::byte> payload,
                                              std::uint64_t offset) {
    if (type != ChunkType::packed) return;
    const auto header = read_cluster_header(payload);
    std::string why;
    if (const auto* cluster = std::get_if<ClusterHeader>(&header))
      (void)tree_.arrive(*cluster, offset, static_cast<std::uint32_t>(kChunkHeaderBytes + payload.size()), why);
    else
      why = std::get<PackedError>(header).message;
    if (!why.empty()) problem(offset, std::move(why));
  };
  StreamReader reader;
  std::vector<std::byte> piece(static_cast<std::size_t>(std::min<std::uint64_t>(kBytesPerRead, source_->size())));
  for (std::uint64_t at = 0;;) {
    const std::size_t count = source_->read(at, piece);
    if (count == 0 || !reader.push(std::span(piece).first(count), arrive)) break;
    at += count;
  }
  reader.finish(arrive);
  for (const StreamProblem& one : reader.problems()) problem(one.offset, one.message);
}

bool LodChunks::push(std::span<const std::byte> bytes, const OnCluster& on_cluster) {
  if (!arrived_) return false;
  const bool more = reader_.push(bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    (void)take(type, payload, offset, on_cluster);
  });
  copy_problems();
  return more;
}

void LodChunks::finish(const OnCluster& on_cluster) {
  if (!arrived_) return;
  reader_.finish([&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    (void)take(type, payload, offset, on_cluster);
  });
  copy_problems();
}

bool LodChunks::set_directory(std::span<const std::byte> chunks) {
  if (!arrived_) return false;
  const std::vector<DirectoryEntry> entries = directory_of(chunks, header_);
  if (entries.empty()) return false;
  const std::size_t senseless = tree_.expect(entries);
  if (senseless > 0)
    problem(header_.directory, std::to_string(senseless) + " invalid entries of the directory are left out");
  ++revision_;
  return true;
}

bool LodChunks::add(std::uint64_t offset, std::span<const std::byte> chunk, const OnCluster& on_cluster) {
  if (!arrived_) return false;
  auto sound = sound_chunk(chunk);
  if (auto* message = std::get_if<std::string>(&sound)) {
    problem(offset, std::move(*message));
    return false;
  }
  return take(std::get<SoundChunk>(sound).type, std::get<SoundChunk>(sound).payload, offset, on_cluster);
}

// Processes a received chunk of a growing stream.
bool LodChunks::take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset,
                     const OnCluster& on_cluster) {
  if (type != ChunkType::packed) return type == ChunkType::directory;
  const auto header = read_cluster_header(payload);
  if (const auto* error = std::get_if<PackedError>(&header)) {
    problem(offset, error->message);
    return false;
  }
  if (arrived_->has(offset)) return true;
  std::string why;
  const auto bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + payload.size());
  const std::uint32_t node = tree_.arrive(std::get<ClusterHeader>(header), offset, bytes, why);
  if (node != kNoNode && !arrived_->add(offset, encode_chunk(type, payload))) {
    tree_.reject(node);
    why = "not enough memory for more chunks";
  }
  if (!why.empty()) {
    problem(offset, std::move(why));
    return false;
  }
  if (on_cluster) on_cluster(node);
  ++revision_;
  return true;
}

void LodChunks::set_most_bytes(std::size_t most_bytes) {
  if (arrived_) arrived_->set_most_bytes(most_bytes);
}

DecodedCluster LodChunks::decode(std::uint32_t index, const Cluster* parent) const {
  const LodNode& node = tree_[index];
  DecodedCluster out;
  std::vector<std::byte> buffer;
  const auto chunk = read_chunk(*source_, node.offset, node.bytes, buffer);
  if (const auto* problem = std::get_if<std::string>(&chunk)) {
    out.problem = *problem;
    return out;
  }
  const SoundChunk& sound = std::get<SoundChunk>(chunk);
  if (sound.type != ChunkType::packed) {
    out.problem = "a chunk is not a cluster, but one is expected";
    return out;
  }
  const auto header = read_cluster_header(sound.payload);
  if (const auto* error = std::get_if<PackedError>(&header)) {
    out.problem = error->message;
    return out;
  }
  out.problem = tree_.misfit(index, std::get<ClusterHeader>(header));
  if (!out.problem.empty()) return out;
  auto decoded = decode_cluster(sound.payload, parent);
  if (const auto* error = std::get_if<PackedError>(&decoded)) {
    out.problem = error->message;
    return out;
  }
  auto cluster = std::make_unique<Cluster>(std::move(std::get<Cluster>(decoded)));
  const PackedVoxels& voxels = cluster->voxels;
  if (node.claimed && voxels.size() != node.voxels) {
    out.problem = "a cluster of " + std::to_string(voxels.size()) + " vectors; the directory gives " +
                  std::to_string(node.voxels);
    return out;
  }
  const float edge = header_.cube.edge / static_cast<float>(1 << cluster->level());
  if (node.boxed && !holds(node.box, box_of_run(voxels, cluster->level(), 0, voxels.size(), header_.cube), edge,
                           header_.description.box)) {
    out.problem = "a cluster exceeds its box in the directory";
    return out;
  }
  out.discs = discs_of(voxels, 0, voxels.size());
  if (parent) out.replaced = discs_of(parent->voxels, cluster->header.first, cluster->header.count);
  if (!node.known && !header_.description.two_sided) out.cone = cone_of(voxels);
  out.cluster = std::move(cluster);
  return out;
}

void LodChunks::reject(std::uint32_t node, std::string why) {
  tree_.reject(node);
  problem(tree_[node].offset, std::move(why));
}

// Copies new problems of the reader.
void LodChunks::copy_problems() {
  for (; reader_problems_ < reader_.problems().size(); ++reader_problems_)
    problem(reader_.problems()[reader_problems_].offset, reader_.problems()[reader_problems_].message);
}

void LodChunks::problem(std::uint64_t offset, std::string message) {
  if (problems_.size() < kMaxProblems) problems_.push_back({offset, std::move(message)});
}

}  // namespace gs::qnv
