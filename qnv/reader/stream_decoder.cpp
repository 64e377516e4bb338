#include "qnv/reader/stream_decoder.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

std::uint32_t vectors_of(const VolumeCluster&, std::size_t, std::size_t count) {
  return static_cast<std::uint32_t>(count);
}

std::uint32_t discs_of_cluster(const Cluster& cluster, std::size_t first, std::size_t count) {
  return discs_of(cluster.voxels, first, count);
}

// Returns i with the order of its lowest `bits` bits reversed.
std::uint64_t reversed(std::uint64_t i, int bits) {
  std::uint64_t out = 0;
  for (int bit = 0; bit < bits; ++bit) out |= (i >> bit & 1) << (bits - 1 - bit);
  return out;
}

template <class T>
void permute(std::span<const std::uint32_t> order, std::vector<T>& values) {
  std::vector<T> moved(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) moved[i] = values[order[i]];
  values = std::move(moved);
}

// Permutes vectors, which are stored in spatial order, by bit-reversed indices. Then every prefix covers all of them
// evenly.
void spread(Cloud& cloud) {
  const std::size_t size = cloud.size();
  const auto bits = static_cast<int>(std::bit_width(size));
  std::vector<std::uint32_t> order;
  order.reserve(size);
  for (std::uint64_t i = 0; order.size() < size; ++i)
    if (const std::uint64_t at = reversed(i, bits); at < size) order.push_back(static_cast<std::uint32_t>(at));
  permute(order, cloud.positions);
  permute(order, cloud.normals);
  permute(order, cloud.weights);
  permute(order, cloud.classes);
  permute(order, cloud.cells);
}

}  // namespace

StreamDecoder::StreamDecoder(std::size_t most_vectors)
    : most_vectors_(most_vectors),
      packed_({read_cluster_header, discs_of_cluster}),
      voxels_({read_volume_cluster_header, vectors_of}) {}

bool StreamDecoder::push(std::span<const std::byte> bytes) {
  const bool good = reader_.push(
      bytes, [this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { add(type, payload); });
  begin_surface();
  return good;
}

void StreamDecoder::begin_surface() {
  if (surface_begun_ || !header() || header()->payload != Payload::displaced) return;
  surface_begun_ = true;
  if (!progressive_.begin(header()->base, header()->description.box, most_vectors_))
    surface_.begin(header()->base, header()->description.box, most_vectors_);
}

void StreamDecoder::finish() {
  reader_.finish([this](ChunkType type, std::span<const std::byte> payload, std::uint64_t) { add(type, payload); });
}

void StreamDecoder::add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing) {
  if (!header()) return;
  begin_surface();
  const bool may_be_meshed = header()->payload == Payload::displaced || header()->payload == Payload::packed;
  if (!missing.empty() && type != ChunkType::records) {
    ++refused_chunks_;
  } else if (type == ChunkType::directory) {
    if (directory_.size() > kMostDirectoryEntries) return;
    const auto entries = decode_directory(payload, header()->description.box);
    directory_.insert(directory_.end(), entries.begin(), entries.end());
  } else if (type == ChunkType::packed && header()->payload == Payload::packed) {
    packed_.add(payload, most_vectors_,
                [](std::span<const std::byte> bytes, const Cluster* parent) { return decode_cluster(bytes, parent); });
  } else if (type == ChunkType::voxels && header()->payload == Payload::voxels) {
    voxels_.add(payload, most_vectors_, [this](std::span<const std::byte> bytes, const VolumeCluster* parent) {
      return decode_volume_cluster(bytes, parent, header()->lattice);
    });
  } else if (type == ChunkType::displaced && header()->payload == Payload::displaced) {
    surface_.add(payload);
  } else if (type == ChunkType::piece && may_be_meshed) {
    const bool good =
        groups_.add(payload, [this](ChunkType whole, std::span<const std::byte> bytes) { add(whole, bytes); });
    if (!good) ++refused_chunks_;
  } else if (type == ChunkType::splits && header()->payload == Payload::displaced) {
    progressive_.add(payload);
  } else if (type == ChunkType::shading && may_be_meshed) {
    exact_.add_shading(payload);
  } else if (type == ChunkType::low_bits && may_be_meshed) {
    exact_.add_low_bits(payload);
  } else if (type == ChunkType::cover && header()->payload == Payload::displaced) {
    exact_.add_cover(payload);
  } else if (type == ChunkType::picture && may_be_meshed) {
    exact_.add_picture(payload);
  } else if (type == ChunkType::normals && may_be_meshed) {
    exact_.add_normals(payload);
  } else if (type == ChunkType::exact && may_be_meshed) {
    exact_.add(payload, header()->description.box, most_vectors_);
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
  if (records_vectors_ + patch->size() > most_vectors_) {
    records_full_ = true;
    ++refused_chunks_;
    return;
  }
  if (!records_) records_.emplace(header()->description);
  const std::size_t more = records_->add(*patch);
  records_vectors_ += more;
  if (more > 0) ++records_revision_;
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

Cloud StreamDecoder::cloud() const {
  Cloud cloud;
  if (!header()) return cloud;
  cloud.description = header()->description;
  cloud.color = header()->color;
  if (records_) append_records(cloud);
  if (exact_.whole())
    exact_.append(cloud, header()->colored);
  else if (progressive_.begun())
    progressive_.shown().append(cloud, header()->colored);
  else
    append_surface(cloud);
  if (exact_.whole()) return cloud;
  packed_.visit_shown([&](const Cluster& cluster, std::size_t first, std::size_t count) {
    append_discs(cluster, first, count, header()->cube, cloud);
  });
  voxels_.visit_shown([&](const VolumeCluster& cluster, std::size_t first, std::size_t count) {
    append_vectors(cluster, first, count, header()->lattice, cloud);
  });
  if (header()->payload == Payload::voxels) spread(cloud);
  return cloud;
}

std::vector<bool> StreamDecoder::covered() const {
  const exact::Cover* cover = exact_.cover();
  const SurfaceStages::Shown main = surface_.main();
  if (!cover || progressive_.begun() || !main.surface || main.number != cover->stage ||
      main.surface->patches().size() != cover->patches.size() ||
      surface_.count().vectors + exact_.vectors() > most_vectors_)
    return {};
  std::vector<bool> covered;
  for (std::size_t p = 0; p < cover->patches.size(); ++p) covered.push_back(cover->covered(p, exact_.triangles()));
  return covered;
}

void StreamDecoder::append_surface(Cloud& cloud) const {
  const std::vector<bool> without = covered();
  surface_.append(cloud, header()->colored, without);
  if (!without.empty()) exact_.append(cloud, header()->colored);
}

std::size_t StreamDecoder::surface_vectors() const {
  const std::vector<bool> without = covered();
  return without.empty() ? surface_.count().vectors : surface_.vectors(without) + exact_.vectors();
}

bool StreamDecoder::has_arrays() const {
  return !header() || header()->payload != Payload::displaced || exact_.whole() || progressive_.begun() ||
         !covered().empty();
}

Cloud StreamDecoder::cloud_to_draw() {
  if (has_arrays()) return cloud();
  Cloud cloud;
  cloud.description = header()->description;
  cloud.color = header()->color;
  cloud.patches = surface_.patches();
  return cloud;
}

}  // namespace gs::qnv
