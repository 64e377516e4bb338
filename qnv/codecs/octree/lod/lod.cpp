#include "qnv/codecs/octree/lod/lod.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::qnv {
namespace {

// Number of chunks that are read to test whether the directory is wrong.
constexpr std::size_t kSamples = 8;
constexpr std::size_t kBytesPerRead = std::size_t{1} << 18;

}  // namespace

OctreeSplats::OctreeSplats(std::shared_ptr<LodStream> of)
    : GeometryBase{of->header().description, of->header().color}, stream(std::move(of)) {}

LodStream::Opened LodStream::make(StreamHeader header, std::size_t cache_bytes, bool grows) {
  if (header.payload != Payload::packed)
    return StreamProblem{11, "a records stream has no levels of detail; expected a packed stream"};
  if (header.meshed) return StreamProblem{20, "the exact mesh replaces the levels of detail"};
  return std::unique_ptr<LodStream>(new LodStream(std::move(header), cache_bytes, grows));
}

LodStream::Opened LodStream::open(std::vector<std::byte> bytes, std::size_t cache_bytes) {
  const auto source = memory_source(std::move(bytes));
  std::size_t header_bytes = 0;
  auto header = read_stream_header(*source, header_bytes);
  if (auto* problem = std::get_if<StreamProblem>(&header)) return std::move(*problem);
  Opened opened = make(std::move(std::get<StreamHeader>(header)), cache_bytes, false);
  if (auto* stream = std::get_if<std::unique_ptr<LodStream>>(&opened)) {
    (*stream)->source_ = source;
    (*stream)->scan();
    if ((*stream)->tree_.root() == kNoNode) return StreamProblem{header_bytes, "has no root cluster"};
  }
  return opened;
}

LodStream::Opened LodStream::open(std::shared_ptr<const ChunkSource> source, std::size_t cache_bytes) {
  std::size_t header_bytes = 0;
  auto header = read_stream_header(*source, header_bytes);
  if (auto* problem = std::get_if<StreamProblem>(&header)) return std::move(*problem);
  Opened opened = make(std::move(std::get<StreamHeader>(header)), cache_bytes, false);
  auto* made = std::get_if<std::unique_ptr<LodStream>>(&opened);
  if (!made) return opened;
  LodStream& stream = **made;
  stream.source_ = std::move(source);
  const std::vector<DirectoryEntry> entries = read_directory(*stream.source_, stream.header_);
  const std::size_t senseless = stream.tree_.set_directory(entries, stream.source_->size());
  if (stream.tree_.root() == kNoNode || !stream.directory_fits()) {
    if (!entries.empty())
      stream.problem(stream.header_.directory, "the directory does not match the chunks; all chunks were read instead");
    stream.tree_ = {};
    stream.scan();
  } else if (senseless > 0) {
    stream.problem(stream.header_.directory,
                   std::to_string(senseless) + " invalid entries of the directory are left out");
  }
  if (stream.tree_.root() == kNoNode) return StreamProblem{header_bytes, "has no root cluster"};
  return opened;
}

LodStream::Opened LodStream::begin(std::span<const std::byte> front, std::size_t cache_bytes) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  auto header = decode_header(front, header_bytes, need_more);
  if (auto* problem = std::get_if<StreamProblem>(&header)) return std::move(*problem);
  Opened opened = make(std::move(std::get<StreamHeader>(header)), cache_bytes, true);
  if (auto* stream = std::get_if<std::unique_ptr<LodStream>>(&opened)) {
    (*stream)->arrived_ = std::make_shared<ArrivedChunks>(LodLimits{}.arrived_bytes);
    (*stream)->source_ = (*stream)->arrived_;
    (void)(*stream)->push(front);
  }
  return opened;
}

// Reports whether the directory belongs to this stream: in a sample, the cluster identifiers and parents must match the
// chunks.
bool LodStream::directory_fits() const {
  std::vector<std::byte> buffer;
  const auto fits = [&](std::uint32_t index) {
    const LodNode& node = tree_[index];
    if (node.broken) return true;
    const auto chunk = read_chunk(*source_, node.offset, node.bytes, buffer);
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    if (!sound) return true;  // damaged chunk; proves nothing about the directory
    const auto header = read_cluster_header(sound->payload);
    const auto* cluster = std::get_if<ClusterHeader>(&header);
    return sound->type == ChunkType::packed && cluster && tree_.misfit(index, *cluster).empty();
  };
  for (std::size_t i = 0; i < tree_.size(); i += std::max<std::size_t>(1, tree_.size() / kSamples))
    if (!fits(static_cast<std::uint32_t>(i))) return false;
  // Requires the first cluster, which every view needs: a wrong directory must not lose it.
  return cache_.decode_one(*source_, tree_.root(), nullptr).cluster != nullptr;
}

// Reads the whole stream once, checks all checksums, and collects all chunks.
void LodStream::scan() {
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
  problems_.insert(problems_.end(), reader.problems().begin(), reader.problems().end());
  keep_few_problems();
}

bool LodStream::push(std::span<const std::byte> bytes) {
  if (!arrived_) return false;
  const bool more = reader_.push(bytes, [this](ChunkType type, std::span<const std::byte> payload,
                                               std::uint64_t offset) { (void)take(type, payload, offset); });
  for (; reader_problems_ < reader_.problems().size(); ++reader_problems_)
    problem(reader_.problems()[reader_problems_].offset, reader_.problems()[reader_problems_].message);
  return more;
}

void LodStream::finish() {
  if (!arrived_) return;
  reader_.finish([this](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    (void)take(type, payload, offset);
  });
  for (; reader_problems_ < reader_.problems().size(); ++reader_problems_)
    problem(reader_.problems()[reader_problems_].offset, reader_.problems()[reader_problems_].message);
}

bool LodStream::set_directory(std::span<const std::byte> chunks) {
  if (!arrived_) return false;
  const std::vector<DirectoryEntry> entries = directory_of(chunks, header_);
  if (entries.empty()) return false;
  const std::size_t senseless = tree_.expect(entries);
  if (senseless > 0)
    problem(header_.directory, std::to_string(senseless) + " invalid entries of the directory are left out");
  ++revision_;
  return true;
}

bool LodStream::add(std::uint64_t offset, std::span<const std::byte> chunk) {
  if (!arrived_) return false;
  auto sound = sound_chunk(chunk);
  if (auto* message = std::get_if<std::string>(&sound)) {
    problem(offset, std::move(*message));
    return false;
  }
  return take(std::get<SoundChunk>(sound).type, std::get<SoundChunk>(sound).payload, offset);
}

// Processes a received chunk of a growing stream.
bool LodStream::take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
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
    tree_[node].broken = true;
    why = "not enough memory for more chunks";
  }
  if (!why.empty()) {
    problem(offset, std::move(why));
    return false;
  }
  cache_.find_box(node);
  ++revision_;
  return true;
}

void LodStream::problem(std::uint64_t offset, std::string message) {
  problems_.push_back({offset, std::move(message)});
  keep_few_problems();
}

void LodStream::keep_few_problems() {
  if (problems_.size() > kMaxProblems) problems_.resize(kMaxProblems);
}

void LodStream::set_limits(const LodLimits& limits) {
  most_discs_ = limits.discs;
  cache_.set_most_bytes(limits.cache_bytes);
  if (arrived_) arrived_->set_most_bytes(limits.arrived_bytes);
}

Splats LodStream::whole() {
  Splats all({header_.description, header_.color});
  (void)visit_whole(most_discs_, [&](const Cluster& cluster, std::size_t first, std::size_t count) {
    append_discs(cluster, first, count, header_.cube, all);
  });
  return all;
}

std::size_t LodStream::count() {
  return visit_whole(std::numeric_limits<std::size_t>::max(), [](const Cluster&, std::size_t, std::size_t) {});
}

std::size_t LodStream::visit_whole(std::size_t most_discs, const OnVoxels& visit) {
  std::size_t discs = 0;
  const std::uint32_t root = tree_.root();
  if (root == kNoNode || !tree_[root].present || tree_[root].broken) return discs;
  const DecodedCluster decoded = cache_.decode_one(*source_, root, nullptr);
  if (decoded.cluster) {
    visit_below(root, *decoded.cluster, most_discs, discs, visit);
  } else {
    tree_[root].broken = true;
    problem(tree_[root].offset, decoded.problem);
  }
  return discs;
}

// Visits the descendants of a cluster, then the cluster. The recursion is no deeper than the octree.
void LodStream::visit_below(std::uint32_t index, const Cluster& cluster, std::size_t most_discs, std::size_t& discs,
                            const OnVoxels& visit) {
  std::vector<std::uint32_t> children;
  for (std::uint32_t child = tree_[index].first_child; child != kNoNode; child = tree_[child].next_sibling)
    if (tree_[child].present && !tree_[child].broken) children.push_back(child);
  std::reverse(children.begin(), children.end());  // in the order in which the chunks were received
  const PackedVoxels& voxels = cluster.voxels;
  std::vector<bool> divided(voxels.size());
  for (const std::uint32_t child : children) {
    const DecodedCluster decoded = cache_.decode_one(*source_, child, &cluster);
    if (!decoded.cluster) {
      tree_[child].broken = true;
      problem(tree_[child].offset, decoded.problem);
      continue;
    }
    const auto first = divided.begin() + decoded.cluster->header.first, last = first + decoded.cluster->header.count;
    if (std::find(first, last, true) != last || decoded.discs > most_discs - std::min(most_discs, discs)) {
      cut_short_ = true;
      continue;
    }
    std::fill(first, last, true);
    visit_below(child, *decoded.cluster, most_discs, discs, visit);
  }
  for (std::size_t i = 0, end = 0; i < voxels.size(); i = end) {
    while (end < voxels.size() && divided[end] == divided[i]) ++end;
    if (divided[i]) continue;
    discs += discs_of(voxels, i, end - i);
    visit(cluster, i, end - i);
  }
}

}  // namespace gs::qnv
