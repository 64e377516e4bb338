#include "qnv/codecs/gaussians/lod/splat_chunks.h"

#include "qnv/codecs/gaussians/harmonics_code.h"
#include "qnv/codecs/gaussians/splat_steps.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace gs::qnv::gaussians {
namespace {

constexpr std::size_t kSampledHeads = 8;  // number of chunks to compare with the directory
// Maximum bytes of restored chunks of a file.
constexpr std::size_t kPatchBytes = std::size_t{64} << 20;

/// Source with restored chunks from the offset kNowhere on.
class PatchedSource final : public ChunkSource {
 public:
  PatchedSource(std::shared_ptr<const ChunkSource> source, std::shared_ptr<const ArrivedChunks> patches)
      : source_(std::move(source)), patches_(std::move(patches)) {}
  [[nodiscard]] std::uint64_t size() const override { return source_->size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    return offset < kNowhere ? source_->read(offset, to) : patches_->read(offset, to);
  }

 private:
  std::shared_ptr<const ChunkSource> source_;
  std::shared_ptr<const ArrivedChunks> patches_;
};

}  // namespace

SplatChunks::SplatChunks(StreamHeader header) : header_(std::move(header)) {
  const GaussianCoding& coding = header_.gaussians;
  precision_ = precision_of(coding, header_.description.box);
}

SplatChunks::Opened SplatChunks::make(std::variant<StreamHeader, StreamProblem> read) {
  if (auto* problem = std::get_if<StreamProblem>(&read)) return std::move(*problem);
  StreamHeader& header = std::get<StreamHeader>(read);
  if (header.payload != Payload::gaussians) return StreamProblem{11, "the payload is not Gaussians"};
  return SplatChunks(std::move(header));
}

SplatChunks::Opened SplatChunks::open(std::shared_ptr<const ChunkSource> source, bool trust_directory) {
  std::size_t header_bytes = 0;
  Opened opened = make(read_stream_header(*source, header_bytes));
  auto* chunks = std::get_if<SplatChunks>(&opened);
  if (!chunks) return opened;
  chunks->source_ = std::move(source);
  if (chunks->header_.parity) {
    chunks->patches_ = std::make_shared<ArrivedChunks>(kPatchBytes);
    chunks->source_ = std::make_shared<PatchedSource>(chunks->source_, chunks->patches_);
  }
  if (trust_directory)
    chunks->read_directory_of_source();
  else
    chunks->scan();
  if (chunks->tree_.root() == kNoCluster) return StreamProblem{header_bytes, "has no root cluster"};
  return opened;
}

SplatChunks::Opened SplatChunks::begin(std::span<const std::byte> front) {
  std::size_t header_bytes = 0;
  bool need_more = false;
  Opened opened = make(decode_header(front, header_bytes, need_more));
  if (auto* chunks = std::get_if<SplatChunks>(&opened)) {
    constexpr std::size_t kArrivedBytes = std::size_t{1} << 30;
    chunks->arrived_ = std::make_shared<ArrivedChunks>(kArrivedBytes);
    chunks->source_ = chunks->arrived_;
    (void)chunks->push(front);
  }
  return opened;
}

// Reads the directory. If the directory is incomplete or wrong, reads all chunks instead.
void SplatChunks::read_directory_of_source() {
  const std::vector<DirectoryEntry> entries = read_directory(*source_, header_);
  const std::size_t invalid = tree_.add_directory(entries, source_->size(), true);
  if (tree_.root() == kNoCluster || !directory_fits()) {
    if (!entries.empty())
      problem(header_.directory, "the directory does not match the chunks; all chunks were read instead");
    tree_ = {};
    scan();
  } else if (invalid > 0) {
    problem(header_.directory, std::to_string(invalid) + " invalid entries of the directory are left out");
  }
}

// Reports whether the directory belongs to this stream: compares it with the heads of sampled clusters.
bool SplatChunks::directory_fits() const {
  std::vector<std::byte> buffer;
  const auto fits = [&](std::uint32_t index) {
    const SplatCluster& cluster = tree_[index];
    if (cluster.broken || cluster.bytes == 0) return true;
    const auto chunk = read_chunk(*source_, cluster.offset, cluster.bytes, buffer);
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    if (!sound) return true;  // a damaged chunk proves nothing about the directory
    const auto packed = parse_cluster(sound->payload);
    return sound->type == ChunkType::gaussians && packed && packed->head.id == cluster.id &&
           packed->head.level == cluster.level;
  };
  for (std::size_t i = 0; i < tree_.size(); i += std::max<std::size_t>(1, tree_.size() / kSampledHeads))
    if (!fits(static_cast<std::uint32_t>(i))) return false;
  // The root cluster must decode, because every view needs it.
  return decode(tree_.root(), nullptr, *std::make_unique<DecodedCluster>());
}

// Collects all chunks of the stream.
void SplatChunks::scan() {
  whole_ = true;
  const StreamReader::OnChunk take = [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    if (offset == kNowhere) {
      offset += restored_;
      if (!patches_->add(offset, encode_chunk(type, payload))) return;
      ++restored_;
    }
    std::string why;
    (void)note(type, payload, offset, why);
    if (!why.empty()) problem(offset, std::move(why));
  };
  for (const StreamProblem& one : read_whole(*source_, patches_ != nullptr, take)) problem(one.offset, one.message);
}

bool SplatChunks::restore() {
  if (!patches_) return false;
  if (!std::exchange(whole_, true)) repair_ = std::make_unique<ChunkRepair>(source_, patches_);
  if (!repair_ || (!waiting_ && !repair_->ended())) return false;
  const ChunkRepair::Result result = repair_->finish();
  repair_ = nullptr;
  bool any = false;
  for (const ChunkRepair::Restored& chunk : result.chunks) any = take_restored(chunk) || any;
  for (const StreamProblem& one : result.problems) problem(one.offset, one.message);
  for (const std::uint32_t cluster : std::exchange(postponed_, {})) tree_.at(cluster).waits = false;
  ++revision_;
  return any;
}

// Replaces a damaged cluster by its restored chunk, or adds harmonics.
bool SplatChunks::take_restored(const ChunkRepair::Restored& chunk) {
  std::vector<std::byte> buffer;
  const auto read = read_chunk(*source_, chunk.offset, chunk.bytes, buffer);
  const auto* sound = std::get_if<SoundChunk>(&read);
  std::string why;
  if (!sound) {
    why = "a restored chunk cannot be read again";
  } else if (is_harmonics(chunk.type)) {
    if (note(chunk.type, sound->payload, chunk.offset, why)) return true;
  } else if (take_restored_cluster(sound->payload, chunk, why)) {
    return true;
  }
  // Without a reason, the chunk was already known.
  if (!why.empty()) problem(chunk.offset, std::move(why));
  return false;
}

// Replaces a damaged cluster by its restored chunk. Returns false and sets `why` if it does not suit the directory.
bool SplatChunks::take_restored_cluster(std::span<const std::byte> payload, const ChunkRepair::Restored& chunk,
                                        std::string& why) {
  const auto packed = parse_cluster(payload);
  const std::uint32_t index = packed ? tree_.find(packed->head.id) : kNoCluster;
  if (index == kNoCluster) {
    why = "a restored cluster of Gaussians is invalid, or missing in the directory";
    return false;
  }
  if (!tree_.note_head(index, packed->head)) {
    why = "a restored cluster of Gaussians contradicts the directory";
    return false;
  }
  tree_.at(index).offset = chunk.offset;
  tree_.at(index).bytes = static_cast<std::uint32_t>(chunk.bytes);
  return true;
}

void SplatChunks::postpone(std::uint32_t cluster) {
  if (std::exchange(tree_.at(cluster).waits, true)) return;
  postponed_.push_back(cluster);
}

// Adds a chunk to the tree. Returns false if it is known, invalid or of another type; sets `why` if it is invalid.
bool SplatChunks::note(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset, std::string& why) {
  const auto bytes = static_cast<std::uint32_t>(kChunkHeaderBytes + payload.size());
  if (type == ChunkType::gaussians) {
    const auto packed = parse_cluster(payload);
    if (!packed) {
      why = "a cluster of Gaussians has an invalid head";
      return false;
    }
    const std::size_t before = tree_.present();
    return tree_.arrive(packed->head, offset, bytes, why) != kNoCluster && tree_.present() > before;
  }
  if (!is_harmonics(type)) return false;
  const auto packed = parse_harmonics(payload);
  if (!packed || header_.gaussians.degree == 0) {
    why = "a chunk of harmonics has an invalid head";
    return false;
  }
  return tree_.arrive(packed->head, offset, bytes, why);
}

bool SplatChunks::push(std::span<const std::byte> bytes) {
  if (!arrived_) return false;
  const bool more = reader_.push(bytes, [&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    (void)take(type, payload, offset);
  });
  copy_problems();
  return more;
}

void SplatChunks::finish() {
  if (!arrived_) return;
  reader_.finish([&](ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
    (void)take(type, payload, offset);
  });
  copy_problems();
  lost_ = {};
}

bool SplatChunks::set_directory(std::span<const std::byte> chunks) {
  if (!arrived_) return false;
  const std::vector<DirectoryEntry> entries = directory_of(chunks, header_);
  if (entries.empty()) return false;
  const std::size_t invalid = tree_.add_directory(entries, header_.directory, false);
  if (invalid > 0)
    problem(header_.directory, std::to_string(invalid) + " invalid entries of the directory are left out");
  ++revision_;
  return true;
}

bool SplatChunks::add(std::uint64_t offset, std::span<const std::byte> chunk) {
  if (!arrived_) return false;
  auto sound = sound_chunk(chunk);
  if (auto* message = std::get_if<std::string>(&sound)) {
    problem(offset, std::move(*message));
    return false;
  }
  return take(std::get<SoundChunk>(sound).type, std::get<SoundChunk>(sound).payload, offset);
}

// Processes a received chunk of a growing stream. Parity restores lost chunks, which get offsets from kNowhere on.
bool SplatChunks::take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
  const LostChunks::Take restored = [this](ChunkType whole, std::span<const std::byte> bytes) {
    (void)store(whole, bytes, kNowhere + restored_++);
  };
  if (type == ChunkType::parity) return !header_.parity || lost_.add(payload, restored);
  if (type != ChunkType::gaussians && !is_harmonics(type))
    return type == ChunkType::directory || type == ChunkType::cluster_directory;
  const bool good = store(type, payload, offset);
  if (header_.parity) lost_.keep(type, payload, restored);
  return good;
}

bool SplatChunks::store(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset) {
  if (arrived_->has(offset)) return true;
  std::string why;
  // Stores the chunk first, because chunks in the tree must be readable.
  if (!arrived_->add(offset, encode_chunk(type, payload)))
    why = "not enough memory for more chunks";
  else if (note(type, payload, offset, why))
    ++revision_;
  if (why.empty()) return true;
  problem(offset, std::move(why));
  return false;
}

void SplatChunks::set_most_bytes(std::size_t most_bytes) {
  if (arrived_) arrived_->set_most_bytes(most_bytes);
}

bool SplatChunks::read_head(std::uint32_t index) {
  const SplatCluster& cluster = tree_[index];
  if (cluster.count > 0 || !cluster.present || cluster.broken) return !cluster.broken;
  std::vector<std::byte> buffer;
  do {
    const auto chunk = read_chunk(*source_, cluster.offset, cluster.bytes, buffer);
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    const auto packed = sound && sound->type == ChunkType::gaussians ? parse_cluster(sound->payload) : std::nullopt;
    if (packed && tree_.note_head(index, packed->head)) return true;
  } while (restore());
  if (repairing()) return false;
  reject(index, "a cluster is damaged, or contradicts the directory");
  return false;
}

bool SplatChunks::decode(std::uint32_t index, const SplatParent* parent, DecodedCluster& to) const {
  const SplatCluster& cluster = tree_[index];
  const auto chunk = read_chunk(*source_, cluster.offset, cluster.bytes, to.chunk);
  const auto* sound = std::get_if<SoundChunk>(&chunk);
  if (!sound || sound->type != ChunkType::gaussians) return false;
  const auto packed = parse_cluster(sound->payload);
  const bool is_root = cluster.parent == kNoCluster;
  if (!packed || packed->head.id != cluster.id || is_root != (packed->head.parent == ClusterHead::kNoParent) ||
      is_root == (parent != nullptr))
    return false;
  const std::size_t first = packed->head.first, last = first + packed->head.count;
  if (parent && (last >= parent->ranks.size() || tree_[cluster.parent].id != packed->head.parent)) return false;
  const SplatNode root = root_node(precision_.box);
  std::span<const SplatNode> parents(&root, 1);
  std::size_t before = 0;  // number of inner Gaussians of the parent before those that this cluster replaces
  if (parent) {
    before = parent->ranks[first];
    parents = std::span(parent->state.inner).subspan(before, parent->ranks[last] - before);
    parent->state.models.load(to.models);
  } else {
    to.models = SplatModels(precision_.trained());
  }
  if (!decode_nodes(packed->bytes, parents, parent != nullptr, to.models, precision_, to.nodes,
                    header_.gaussians.degree > 0 ? &to.origins : nullptr))
    return false;
  for (NodeOrigin& origin : to.origins) origin.parent = static_cast<std::uint16_t>(origin.parent + before);
  return true;
}

ClusterHarmonics SplatChunks::decode_harmonics(std::uint32_t index, std::span<const SplatNode> leaves,
                                               std::span<const SplatNode> merged) const {
  const int degree = header_.gaussians.degree;
  const std::size_t per = harmonic_count(degree);
  ClusterHarmonics all;
  std::vector<std::byte> buffer;
  for (std::uint32_t i = tree_[index].harmonics; i != kNoCluster; i = tree_.harmonics(i).next) {
    const HarmonicsChunk& place = tree_.harmonics(i);
    if (!place.present) continue;
    const auto chunk = read_chunk(*source_, place.offset, place.bytes, buffer);
    const auto* sound = std::get_if<SoundChunk>(&chunk);
    const auto packed = sound && is_harmonics(sound->type) ? parse_harmonics(sound->payload) : std::nullopt;
    all.damaged = all.damaged || !sound;
    if (!packed || packed->head.cluster != tree_[index].id) continue;
    const bool coarse = sound->type == ChunkType::coarse_harmonics;
    const std::span<const SplatNode> nodes = coarse ? merged : leaves;
    const std::size_t first = packed->head.first, last = first + packed->head.count;
    if (last > nodes.size()) continue;
    Reader reader{BinaryDecoder(packed->bytes)};
    HarmonicModels models;
    std::array<std::array<int, 3>, harmonic_count(Gaussians::kMaxDegree)> codes{};
    std::vector<glm::vec3> own;
    std::vector<bool> has_own;  // other Gaussians inherit those of an ancestor
    for (std::size_t k = first; k < last && !reader.coder.exhausted(); ++k) {
      has_own.push_back(code_harmonics(reader, models, degree, codes) || !coarse);
      const double step = harmonic_step(nodes[k], precision_);
      for (std::size_t c = 0; c < per; ++c) own.push_back(glm::vec3(rgb_of(codes[c], step)));
    }
    if (reader.coder.exhausted() || own.size() != per * (last - first)) continue;
    std::vector<glm::vec3>& values = coarse ? all.merged : all.leaves;
    std::vector<bool>& known = coarse ? all.known_merged : all.known_leaves;
    values.resize(per * nodes.size());
    known.resize(nodes.size());
    std::ranges::copy(own, values.begin() + static_cast<std::ptrdiff_t>(per * first));
    std::copy(has_own.begin(), has_own.end(), known.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return all;
}

std::vector<SplatChunks::Received> SplatChunks::received() const {
  std::vector<Received> all;
  std::vector<std::uint32_t> order;
  if (tree_.root() != kNoCluster) order.push_back(tree_.root());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const SplatCluster& cluster = tree_[order[i]];
    if (cluster.present) all.push_back({ChunkType::gaussians, cluster.offset, cluster.bytes});
    for (std::uint32_t child = cluster.first_child; child != kNoCluster; child = tree_[child].next_sibling)
      order.push_back(child);
  }
  for (const std::uint32_t index : order)
    for (std::uint32_t i = tree_[index].harmonics; i != kNoCluster; i = tree_.harmonics(i).next)
      if (tree_.harmonics(i).present)
        all.push_back({ChunkType::harmonics, tree_.harmonics(i).offset, tree_.harmonics(i).bytes});
  return all;
}

void SplatChunks::reject(std::uint32_t cluster, std::string why) {
  tree_.at(cluster).broken = true;
  problem(tree_[cluster].offset, std::move(why));
}

// Copies new problems of the reader.
void SplatChunks::copy_problems() {
  for (; reader_problems_ < reader_.problems().size(); ++reader_problems_)
    problem(reader_.problems()[reader_problems_].offset, reader_.problems()[reader_problems_].message);
}

void SplatChunks::problem(std::uint64_t offset, std::string message) {
  if (problems_.size() < kMaxProblems) problems_.push_back({offset, std::move(message)});
}

}  // namespace gs::qnv::gaussians
