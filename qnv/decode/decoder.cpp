#include "qnv/decode/decoder.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::qnv {
namespace {

// Chunks that wait for a parent that may never come.
constexpr std::size_t kMostWaitingBytes = std::size_t{64} << 20;

}  // namespace

bool StreamDecoder::push(std::span<const std::byte> bytes) {
  return reader_.push(
      bytes, [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { add(type, payload); });
}

void StreamDecoder::finish() {
  reader_.finish([this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { add(type, payload); });
}

void StreamDecoder::add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  if (!header()) return;
  if (!missing.empty() && type != ChunkType::records) {
    ++refused_chunks_;
  } else if (type == ChunkType::directory) {
    if (directory_.size() > kMostDirectoryEntries) return;
    const auto entries = decode_directory(payload, header()->description.box);
    directory_.insert(directory_.end(), entries.begin(), entries.end());
  } else if (type == ChunkType::packed && header()->payload == Payload::packed) {
    add_packed(payload);
  } else if (type == ChunkType::records && header()->payload == Payload::records) {
    add_records(payload, missing);
  } else {
    ++refused_chunks_;
  }
}

void StreamDecoder::add_records(std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  const auto decoded = decode_records(payload, missing);
  const auto* patch = std::get_if<RecordsPatch>(&decoded);
  if (!patch) {
    ++refused_chunks_;
    return;
  }
  if (vectors_ + patch->size() > most_vectors_) {
    full_ = true;
    ++refused_chunks_;
    return;
  }
  if (!records_) records_.emplace(header()->description);
  const std::size_t more = records_->add(*patch);
  vectors_ += more;
  if (more > 0) ++revision_;
}

void StreamDecoder::append_records(Cloud& cloud) const {
  cloud.positions.assign(records_->positions().begin(), records_->positions().end());
  cloud.normals.assign(records_->normals().begin(), records_->normals().end());
  cloud.weights = records_->conserved_weights();
  for (float& weight : cloud.weights) weight = std::max(weight, std::numeric_limits<float>::min());
  const auto codes = records_->colors();
  if (header()->description.kind == Kind::volume) {
    cloud.classes.assign(codes.begin(), codes.end());
  } else if (!header()->palette.empty()) {
    const std::vector<Rgb8>& palette = header()->palette;
    cloud.colors.reserve(codes.size());
    for (const std::uint8_t code : codes) cloud.colors.push_back(code < palette.size() ? palette[code] : cloud.color);
  }
}

void StreamDecoder::add_packed(std::span<const std::byte> payload) {
  const auto read = read_cluster_header(payload);
  const auto* cluster_header = std::get_if<ClusterHeader>(&read);
  if (!cluster_header || clusters_.contains(cluster_header->id)) {
    ++refused_chunks_;
    return;
  }
  const Held* parent = nullptr;
  if (cluster_header->parent != kNoParent) {
    const auto found = clusters_.find(cluster_header->parent);
    if (found == clusters_.end()) {
      if (waiting_bytes_ + cost(payload) > kMostWaitingBytes) {
        ++refused_chunks_;
        return;
      }
      waiting_bytes_ += cost(payload);
      orphans_.emplace(cluster_header->parent, std::vector<std::byte>(payload.begin(), payload.end()));
      return;
    }
    parent = &found->second;
  }
  auto decoded = decode_cluster(payload, parent ? &parent->cluster : nullptr);
  auto* cluster = std::get_if<Cluster>(&decoded);
  // A place is refined once, the root too.
  bool again = !parent && rooted_;
  for (std::size_t i = 0; cluster && parent && i < cluster->header.count; ++i)
    again = again || parent->refined[cluster->header.first + i];
  if (!cluster || again) {
    ++refused_chunks_;
    return;
  }
  // What was refined is kept too, since others may refine the rest of its cluster.
  const std::size_t voxels = cluster->voxels.size();
  if (vectors_ + discs_of(cluster->voxels, 0, voxels) > most_vectors_ || (voxels_ + voxels) / 2 > most_vectors_) {
    full_ = true;
    ++refused_chunks_;
    return;
  }
  take(std::move(*cluster));
}

void StreamDecoder::take(Cluster cluster) {
  const ClusterHeader header = cluster.header;
  if (header.parent != kNoParent) {
    Held& parent = clusters_.find(header.parent)->second;
    vectors_ -= discs_of(parent.cluster.voxels, header.first, header.count);
    std::fill_n(parent.refined.begin() + header.first, header.count, true);
  }
  if (header.parent == kNoParent) rooted_ = true;
  vectors_ += discs_of(cluster.voxels, 0, cluster.voxels.size());
  voxels_ += cluster.voxels.size();
  ++revision_;
  Held& held = clusters_[header.id];
  held.refined.resize(cluster.voxels.size());
  held.cluster = std::move(cluster);
  // What came too early.
  std::vector<std::vector<std::byte>> ready;
  const auto [first, last] = orphans_.equal_range(header.id);
  for (auto i = first; i != last; ++i) {
    waiting_bytes_ -= cost(i->second);
    ready.push_back(std::move(i->second));
  }
  orphans_.erase(first, last);
  for (const auto& payload : ready) add_packed(payload);
}

Cloud StreamDecoder::cloud() const {
  Cloud cloud;
  if (!header()) return cloud;
  cloud.description = header()->description;
  cloud.color = header()->color;
  if (records_) append_records(cloud);
  for (const auto& [id, held] : clusters_) {
    const std::size_t size = held.refined.size();
    for (std::size_t i = 0; i < size;) {
      std::size_t end = i;
      while (end < size && held.refined[end] == held.refined[i]) ++end;
      if (!held.refined[i]) append_discs(held.cluster, i, end - i, header()->cube, cloud);
      i = end;
    }
  }
  return cloud;
}

}  // namespace gs::qnv
