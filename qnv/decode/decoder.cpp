#include "qnv/decode/decoder.h"

#include "qnv/displaced/subdivision.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::qnv {
namespace {

// Chunks that wait for a parent that may never come.
constexpr std::size_t kMostWaitingBytes = std::size_t{64} << 20;

}  // namespace

bool StreamDecoder::push(std::span<const std::byte> bytes) {
  const bool good = reader_.push(
      bytes, [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { add(type, payload); });
  begin_surface();
  return good;
}

// The first stage is a part of the header: it is there before any chunk.
void StreamDecoder::begin_surface() {
  if (begun_ || !header() || header()->payload != Payload::displaced) return;
  begun_ = true;
  if (auto first = displaced::decode_stage(header()->base))
    add_stage(0, std::move(*first));
  else
    ++refused_chunks_;
}

void StreamDecoder::add_stage(int number, displaced::StageHeader stage) {
  const displaced::Patches patches(stage.base.triangles, static_cast<std::uint32_t>(stage.base.vertices.size()));
  while (stage.depth > 0 && patches.vertices_at(stage.depth) > most_vectors_) {
    full_ = true;
    --stage.depth;
  }
  stages_.emplace(number, displaced::Surface(std::move(stage), header()->description.box));
  ++revision_;
  count_surface();
  const auto [first, last] = waiting_.equal_range(number);
  std::vector<std::vector<std::byte>> ready;
  for (auto i = first; i != last; ++i) {
    waiting_bytes_ -= cost(i->second);
    ready.push_back(std::move(i->second));
  }
  waiting_.erase(first, last);
  for (const auto& payload : ready) add_displaced(payload);
}

void StreamDecoder::add_displaced(std::span<const std::byte> payload) {
  begin_surface();
  const auto cluster = displaced::decode_cluster_header(payload);
  if (!cluster) {
    ++refused_chunks_;
    return;
  }
  if (cluster->kind == displaced::ClusterHeader::Kind::base) {
    if (stages_.contains(cluster->stage)) return;  // bases come more than once, so that one gets through
    auto stage = displaced::decode_stage(payload.subspan(cluster->bytes));
    if (stage)
      add_stage(cluster->stage, std::move(*stage));
    else
      ++refused_chunks_;
    return;
  }
  const auto found = stages_.find(cluster->stage);
  if (found == stages_.end()) {
    if (waiting_bytes_ + cost(payload) > kMostWaitingBytes) {
      ++refused_chunks_;
      return;
    }
    waiting_bytes_ += cost(payload);
    waiting_.emplace(cluster->stage, std::vector<std::byte>(payload.begin(), payload.end()));
    return;
  }
  if (!found->second.add(*cluster, payload)) {
    ++refused_chunks_;
    return;
  }
  ++revision_;
  count_surface();
}

const displaced::Surface* StreamDecoder::stage() const {
  for (auto i = stages_.rbegin(); i != stages_.rend(); ++i)
    if (!i->second.header().beside && i->second.clusters() >= static_cast<std::size_t>(i->second.header().clusters))
      return &i->second;
  return stages_.empty() ? nullptr : &stages_.begin()->second;
}

void StreamDecoder::count_surface() {
  vectors_ = 0;
  if (const displaced::Surface* shown = stage()) vectors_ += shown->slots().vertices_at(shown_level(*shown));
  for (const auto& [number, surface] : stages_)
    if (surface.header().beside && &surface != stage()) vectors_ += surface.slots().vertices_at(shown_level(surface));
}

int StreamDecoder::shown_level(const displaced::Surface& surface) {
  // One level beyond what has arrived is smooth, and costs nothing.
  return std::min(std::max(surface.header().depth, 0), surface.finest() + 1);
}

void StreamDecoder::append_surface(const displaced::Surface& surface, Cloud& cloud) const {
  const int level = shown_level(surface);
  const std::vector<glm::vec3> places = surface.positions(level);
  const std::vector<Rgb8> colors = surface.vertex_colors(level);
  const std::vector<glm::vec3> normals = displaced::slot_normals(surface.patches(), surface.slots(), level, places);
  const std::vector<std::uint32_t> vertex_of = surface.vertices_of_slots(level);
  const auto start = static_cast<std::uint32_t>(cloud.positions.size());
  cloud.normals.insert(cloud.normals.end(), normals.begin(), normals.end());
  cloud.positions.reserve(start + vertex_of.size());
  for (const std::uint32_t v : vertex_of) cloud.positions.push_back(places[v]);
  if (header()->colored) {
    cloud.colors.reserve(start + vertex_of.size());
    for (const std::uint32_t v : vertex_of) cloud.colors.push_back(colors.empty() ? cloud.color : colors[v]);
  }
  const std::size_t first = cloud.triangles.size();
  const std::vector<std::uint32_t> triangles = surface.triangles(level);
  cloud.triangles.reserve(first + triangles.size());
  for (const std::uint32_t corner : triangles) cloud.triangles.push_back(start + corner);
  // A vector stands for a third of the triangles round it.
  cloud.weights.resize(cloud.positions.size(), std::numeric_limits<float>::min());
  for (std::size_t i = first; i + 2 < cloud.triangles.size(); i += 3) {
    const std::uint32_t* t = cloud.triangles.data() + i;
    const glm::vec3 a = cloud.positions[t[0]];
    const float third = glm::length(glm::cross(cloud.positions[t[1]] - a, cloud.positions[t[2]] - a)) / 6;
    for (std::size_t k = 0; k < 3; ++k) cloud.weights[t[k]] += third;
  }
  for (glm::vec3& n : cloud.normals)
    if (n == glm::vec3(0)) n = {0, 0, 1};
}

void StreamDecoder::finish() {
  begin_surface();
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
  } else if (type == ChunkType::displaced && header()->payload == Payload::displaced) {
    add_displaced(payload);
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
  if (const displaced::Surface* shown = stage()) append_surface(*shown, cloud);
  for (const auto& [number, surface] : stages_)
    if (surface.header().beside && &surface != stage()) append_surface(surface, cloud);
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
