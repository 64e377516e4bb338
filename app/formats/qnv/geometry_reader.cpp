#include "app/formats/qnv/geometry_reader.h"
#include "app/formats/qnv/held_streams.h"
#include "app/formats/qnv/surface_pictures.h"

#include "app/formats/common/color_key.h"
#include "app/formats/confined/confined_import.h"
#include "app/formats/splats/splats.h"
#include "app/formats/volume/held_values.h"
#include "app/formats/volume/volume.h"
#include "base/gzip.h"
#include "net/files/file.h"
#include "qnv/codecs/displaced/tessellation/patch_surface.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/records/record.h"
#include "qnv/reader/loss.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/gradients.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kReadBytes = std::size_t{1} << 20;
// Maximum number of vectors of a volume that is opened only for viewing.
constexpr std::uint64_t kMaxGradients = std::uint64_t{1} << 24;
// Bytes per vector that is stored and drawn, and bytes per vector while gradients are sorted.
constexpr std::uint64_t kHeldBytes = 64, kGradientBytes = 90;
constexpr std::chrono::milliseconds kCancelWait{50};
constexpr const char* kLate = "the time limit for loading was reached; skipped the rest of the file";

class GeometryFileReader {
 public:
  GeometryFileReader(const GeometryFile& file, Diagnostics& diagnostics, const LoadLimit& limit,
                     const WorldBudget& budget)
      : file_(file), diagnostics_(diagnostics), limit_(limit), budget_(budget) {}

  std::optional<qnv::Geometry> levels(qnv::LodStream::Opened opened);
  std::optional<qnv::Geometry> cuts(qnv::SplatStream::Opened opened);
  std::optional<qnv::Geometry> bricks(const std::shared_ptr<const qnv::ChunkSource>& source);
  std::optional<qnv::Geometry> brick_series(const std::shared_ptr<const qnv::ChunkSource>& source,
                                            const qnv::StreamHeader& header, BrickShare share);
  std::optional<qnv::Geometry> stream();
  std::optional<qnv::Geometry> splats(const ContentType& type);

 private:
  void report(Severity severity, std::string message) {
    diagnostics_.add({severity, file_.path, {}, std::move(message)});
  }

  const GeometryFile& file_;
  std::vector<std::byte> arrived_;  // bytes that remain after simulated loss; else empty
  Diagnostics& diagnostics_;
  LoadLimit limit_;
  WorldBudget budget_;
};

// Source of chunks in a file. Uses pread, because a mapping would crash if the file is truncated while it is open.
class FileSource : public qnv::ChunkSource {
 public:
  explicit FileSource(net::RandomAccessFile file) : file_(std::move(file)) {}
  [[nodiscard]] std::uint64_t size() const override { return file_.size(); }
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::byte> to) const override {
    return file_.read(offset, to);
  }

 private:
  net::RandomAccessFile file_;
};

// Keeps an octree-packed stream encoded, in memory or in its file. Views decode the visible parts.
std::optional<qnv::Geometry> GeometryFileReader::levels(qnv::LodStream::Opened opened) {
  auto* made = std::get_if<std::unique_ptr<qnv::LodStream>>(&opened);
  if (!made) return std::nullopt;
  const std::shared_ptr<qnv::LodStream> stream = hold_levels(std::move(*made), budget_, false);
  for (const qnv::StreamProblem& problem : stream->problems())
    if (!(file_.cut && problem.message.starts_with("ends ")))
      report(Severity::warning, "byte " + std::to_string(problem.offset) + ": " + problem.message);
  return qnv::OctreeSplats(stream);
}

// Leaves a stream of Gaussians encoded, in memory or in its file. Views decode the visible parts.
std::optional<qnv::Geometry> GeometryFileReader::cuts(qnv::SplatStream::Opened opened) {
  auto* made = std::get_if<std::unique_ptr<qnv::SplatStream>>(&opened);
  if (!made) return std::nullopt;
  const std::shared_ptr<qnv::SplatStream> stream = hold_cuts(std::move(*made), budget_, false);
  for (const qnv::StreamProblem& problem : stream->problems())
    if (!(file_.cut && problem.message.starts_with("ends ")))
      report(Severity::warning, "byte " + std::to_string(problem.offset) + ": " + problem.message);
  return gaussians_of(stream);
}

// Keeps a volume that is larger than memory in its file. Views decode the visible parts.
std::optional<qnv::Geometry> GeometryFileReader::bricks(const std::shared_ptr<const qnv::ChunkSource>& source) {
  std::size_t header_bytes = 0;
  const auto header = qnv::read_stream_header(*source, header_bytes);
  const auto* const known = std::get_if<qnv::StreamHeader>(&header);
  if (!known || !qnv::BrickVolume::suits(*known, most_decoded_vectors(*budget_))) return std::nullopt;
  BrickShare share(budget_, false);
  if (!known->steps.times.empty()) return brick_series(source, *known, std::move(share));
  auto opened = qnv::BrickVolume::open(source, share.limits, [&] { return limit_.over(); });
  if (const auto* const problem = std::get_if<qnv::StreamProblem>(&opened)) {
    report(Severity::error, "byte " + std::to_string(problem->offset) + ": " + problem->message);
    return std::nullopt;
  }
  return volume_of(hold_bricks(std::move(std::get<0>(opened)), std::move(share)));
}

// Keeps a time series of such volumes in its file.
std::optional<qnv::Geometry> GeometryFileReader::brick_series(const std::shared_ptr<const qnv::ChunkSource>& source,
                                                              const qnv::StreamHeader& header, BrickShare share) {
  const qnv::BrickLimits limits = share.limits;
  const auto series =
      std::make_shared<qnv::BrickSeries>(source, header, limits, std::make_shared<const BrickShare>(std::move(share)));
  const qnv::ShownStep step = file_.origin.component.step.value_or(qnv::ShownStep());
  auto opened = series->open(qnv::step_number(step, header.steps.times), [&] { return limit_.over(); });
  if (auto* const volume = std::get_if<qnv::Volume>(&opened)) return std::move(*volume);
  const auto& problem = std::get<qnv::StreamProblem>(opened);
  report(Severity::error, "byte " + std::to_string(problem.offset) + ": " + problem.message);
  return std::nullopt;
}

std::optional<qnv::Geometry> GeometryFileReader::stream() {
  const bool as_it_lies = !file_.cut && !(file_.loss > 0) && file_.bytes.size() >= net::MappedFile::kMappedSize;
  if (as_it_lies && qnv::is_stream(file_.bytes)) {
    const auto source = stream_source(file_.path);
    // The path may refer to another file by now. Compare the sizes.
    if (source && source->size() == file_.bytes.size()) {
      if (file_.to_draw) {
        if (auto geometry = bricks(source)) return geometry;
        if (auto geometry = cuts(qnv::SplatStream::open(source))) return geometry;
      }
      if (auto geometry = levels(qnv::LodStream::open(source))) return geometry;
    }
  }
  if (!is_gzip(file_.bytes)) {
    std::vector<std::byte> bytes = file_.loss > 0 ? qnv::drop_packets(file_.bytes, file_.loss, file_.loss_seed)
                                                  : std::vector<std::byte>(file_.bytes.begin(), file_.bytes.end());
    if (file_.loss > 0) arrived_ = bytes;
    if (file_.to_draw)
      if (auto geometry = cuts(qnv::SplatStream::open(bytes))) return geometry;
    if (auto geometry = levels(qnv::LodStream::open(std::move(bytes)))) return geometry;
  }
  qnv::StreamDecoder decoder(most_decoded_vectors(*budget_));
  decoder.show({file_.origin.component.index, file_.origin.component.magnitude, file_.origin.component.chosen,
                file_.origin.component.step.value_or(qnv::ShownStep())});
  bool late = false;
  const auto push = [&](std::span<const std::byte> bytes) {
    while (!bytes.empty() && !late) {
      const std::size_t size = std::min(bytes.size(), kReadBytes);
      if (!decoder.push(bytes.first(size))) return false;
      bytes = bytes.subspan(size);
      late = limit_.over();
    }
    return !late;
  };
  if (is_gzip(file_.bytes)) {
    const auto problem =
        gunzip(file_.bytes, budget_, [&](std::string_view piece) { return push(std::as_bytes(std::span(piece))); });
    if (problem && !file_.cut) report(Severity::warning, *problem);
  } else {
    (void)push(arrived_.empty() ? file_.bytes : std::span<const std::byte>(arrived_));
  }
  if (!decoder.header() || !(file_.cut || late)) decoder.finish();
  if (late) report(Severity::error, kLate);
  for (const qnv::StreamProblem& problem : decoder.problems())
    report(decoder.header() ? Severity::warning : Severity::error,
           "byte " + std::to_string(problem.offset) + ": " + problem.message);
  if (decoder.refused_chunks() > 0 && !decoder.full())
    report(Severity::warning, std::to_string(decoder.refused_chunks()) + " invalid chunks are left out");
  if (decoder.full())
    report(Severity::error, "vectors need " + budget_->refusal(Resource::vectors) + "; the finer ones are left out");
  if (!decoder.header()) return std::nullopt;
  if (file_.to_draw) return decoder.geometry_to_draw();
  qnv::Geometry geometry = decoder.geometry();
  if (auto* mesh = geometry.as<qnv::IndexedMesh>()) color_by_picture(*mesh, budget_);
  return geometry;
}

std::optional<qnv::Geometry> GeometryFileReader::splats(const ContentType& type) {
  UnpackedBytes unpacked;
  std::span<const std::byte> bytes = file_.bytes;
  if (is_gzip(bytes) && !type.unpacks_itself) {
    unpacked = unpack_gzip(bytes, budget_, Resource::files);
    if (unpacked.problem && !file_.cut) report(Severity::error, *unpacked.problem);
    bytes = unpacked.bytes.span();
  }
  ImportSource source{bytes, file_.path, file_.origin.read_beside, budget_, diagnostics_};
  source.local = file_.local;
  Asset asset = read_confined(type, source);
  qnv::Geometry geometry;
  if (auto* splats = std::get_if<qnv::Splats>(&asset))
    geometry = std::move(*splats);
  else if (auto* gaussians = std::get_if<qnv::Gaussians>(&asset))
    geometry = std::move(*gaussians);
  else
    return std::nullopt;
  for (const auto& [key, value] : geometry.description().metadata) {
    if (!file_.cut && key.ends_with(" missing")) report(Severity::error, "the file ends early: " + key + ": " + value);
  }
  return geometry;
}

/// Returns the bytes of a geometry as stored and drawn.
std::uint64_t bytes_of(const qnv::Geometry& geometry) {
  const auto* patches = geometry.as<qnv::SurfacePatches>();
  return patches ? patches->bytes() : geometry.size() * kHeldBytes;
}

qnv::Rgb8 color_at(const std::vector<qnv::TransferPoint>& points, float value) {
  if (value <= points.front().value) return points.front().color;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const qnv::TransferPoint &a = points[i - 1], &b = points[i];
    if (value > b.value) continue;
    const float t = b.value > a.value ? (value - a.value) / (b.value - a.value) : 1;
    const auto mix = [t](std::uint8_t from, std::uint8_t to) {
      return static_cast<std::uint8_t>(static_cast<float>(from) +
                                       t * (static_cast<float>(to) - static_cast<float>(from)) + 0.5f);
    };
    return {mix(a.color.r, b.color.r), mix(a.color.g, b.color.g), mix(a.color.b, b.color.b)};
  }
  return points.back().color;
}

}  // namespace

std::uint64_t most_gradients(const Budget& budget) { return budget.left(Resource::vectors) / kGradientBytes; }

std::size_t most_decoded_vectors(const Budget& budget) {
  return static_cast<std::size_t>(budget.left(Resource::vectors) / kDecodedBytes);
}

BrickShare::BrickShare(const WorldBudget& budget, bool grows, std::uint64_t parts)
    : bricks(budget, Resource::vectors), arrived(budget, Resource::files) {
  // Parts of the remaining budget: bricks, and the level that is decoded as a whole.
  constexpr std::uint64_t kBasePart = 8, kArrivedPart = 16;
  constexpr std::uint64_t kLeast = std::uint64_t{8} << 20;
  const std::uint64_t left = budget->left(Resource::vectors);
  limits.base_vectors = std::min(limits.base_vectors, static_cast<std::size_t>(left / kBasePart / kDecodedBytes));
  (void)bricks.grow(left / parts + limits.base_vectors * kDecodedBytes);
  limits.brick_bytes = static_cast<std::size_t>(std::max(left / parts, kLeast));
  if (grows) (void)arrived.grow(budget->left(Resource::files) / kArrivedPart);
  limits.arrived_bytes = static_cast<std::size_t>(std::max(arrived.amount(), kLeast));
}

std::shared_ptr<qnv::BrickVolume> hold_bricks(std::shared_ptr<qnv::BrickVolume> volume, BrickShare share) {
  struct Held {
    std::shared_ptr<qnv::BrickVolume> volume;
    BrickShare share;
  };
  auto held = std::make_shared<Held>(Held{std::move(volume), std::move(share)});
  return {held, held->volume.get()};
}

qnv::Volume volume_of(const std::shared_ptr<qnv::BrickVolume>& bricks) {
  qnv::Volume volume = *bricks->latest();
  volume.detail = bricks;
  volume.requests = bricks;
  return volume;
}

std::shared_ptr<qnv::ArrayVolume> hold_array(qnv::VolumeSource source, const WorldBudget& budget,
                                             std::chrono::milliseconds patience) {
  struct Held {
    BrickShare share;
    qnv::ArrayVolume volume;
  };
  // Bricks of arrays come with all their vectors, while those of streams share theirs with coefficients.
  constexpr std::uint64_t kArrayParts = 3;
  // The overview has at most 2 million samples, so that its vectors are found in a fraction of a second.
  constexpr std::size_t kOverviewVectors = std::size_t{1} << 18;
  BrickShare share(budget, false, kArrayParts);
  share.limits.base_vectors = std::min(share.limits.base_vectors, kOverviewVectors);
  if (!qnv::ArrayVolume::suits(source, share.limits.base_vectors)) return nullptr;
  const qnv::BrickLimits limits = share.limits;
  // The members are made in place, because threads use the volume at its address.
  const std::shared_ptr<Held> held(new Held{std::move(share), {std::move(source), limits, patience}});
  return {held, &held->volume};
}

qnv::Volume volume_of(const std::shared_ptr<qnv::ArrayVolume>& array) {
  qnv::Volume volume = *array->overview();
  volume.detail = array;
  return volume;
}

bool has_room_for(const qnv::Geometry& geometry, const Budget& budget) {
  return bytes_of(geometry) <= budget.left(Resource::vectors);
}

std::shared_ptr<const qnv::Geometry> hold_geometry(qnv::Geometry geometry, const WorldBudget& budget) {
  struct Held {
    qnv::Geometry geometry;
    Share share;
  };
  auto held = std::make_shared<Held>(Held{std::move(geometry), Share(budget, Resource::vectors)});
  if (!held->share.grow(bytes_of(held->geometry))) return nullptr;
  return {held, &held->geometry};
}

std::shared_ptr<const qnv::ChunkSource> stream_source(const std::string& path) {
  auto opened = net::open_file(path);
  auto* file = std::get_if<net::RandomAccessFile>(&opened);
  return file ? std::make_shared<const FileSource>(std::move(*file)) : nullptr;
}

Deadline::Deadline(const LoadLimit& limit)
    : thread_([this, limit](const std::stop_token& stop) {
        std::unique_lock lock(mutex_);
        // The predicate is never true: the thread waits for the deadline, or until the work ends. Cancellation does not
        // notify the condition variable, so the thread polls.
        while (!stop.stop_requested() && !limit.over()) {
          const auto next = limit.cancelled ? std::min(limit.at, Clock::now() + kCancelWait) : limit.at;
          (void)done_.wait_until(lock, stop, next, [] { return false; });
        }
        if (!stop.stop_requested()) progress.cancelled = true;
      }) {}

Deadline::~Deadline() = default;

std::optional<qnv::Geometry> read_geometry(const ContentType& type, const GeometryFile& file, Diagnostics& diagnostics,
                                           const LoadLimit& limit, const WorldBudget& budget) {
  GeometryFileReader reader(file, diagnostics, limit, budget);
  if (file.bytes.empty()) {
    diagnostics.add({Severity::error, file.path, {}, "the file is empty; expected " + std::string(type.name)});
    return std::nullopt;
  }
  if (type.content == ContentClass::stream) return reader.stream();
  if (type.content == ContentClass::splats) return reader.splats(type);
  const auto source = open_volume_source(type, file, diagnostics, budget);
  return source ? read_gradients(*source, file.path, false, diagnostics, limit, budget) : std::nullopt;
}

std::optional<qnv::VolumeSource> open_volume_source(const ContentType& type, const GeometryFile& file,
                                                    Diagnostics& diagnostics, const WorldBudget& budget) {
  if (file.cut) {
    diagnostics.add({Severity::error, file.path, {}, "a volume cannot be read in part"});
    return std::nullopt;
  }
  ImportSource from{file.bytes,  file.path,        file.origin.read_beside, budget,
                    diagnostics, file.origin.name, file.origin.component};
  from.local = file.local;
  from.read_files = file.origin.read_files;
  from.list_folder = file.origin.list_folder;
  from.need = file.origin.need;
  Asset asset = type.read(from);
  auto* const source = std::get_if<qnv::VolumeSource>(&asset);
  return source ? std::optional(std::move(*source)) : std::nullopt;
}

std::optional<qnv::Geometry> read_gradients(const qnv::VolumeSource& source, const std::string& path, bool keep_values,
                                            Diagnostics& diagnostics, const LoadLimit& limit,
                                            const WorldBudget& budget) {
  const auto report = [&](Severity severity, std::string message) {
    diagnostics.add({severity, path, {}, std::move(message)});
  };
  Deadline deadline(limit);
  std::shared_ptr<const qnv::VolumeValues> values;
  if (keep_values) values = hold_values(source, budget, deadline.progress);
  qnv::GradientOptions options;
  options.vectors = std::min(kMaxGradients, most_gradients(*budget));
  Share share(budget, Resource::vectors);
  if (!share.grow(options.vectors * kGradientBytes)) options.vectors = 0;  // another thread used the memory
  auto found = qnv::gradient_vectors(values ? values->source : source, options, &deadline.progress);
  if (source.trouble)
    if (std::string trouble = source.trouble(); !trouble.empty()) report(Severity::warning, std::move(trouble));
  if (const auto* problem = std::get_if<qnv::VolumeError>(&found)) {
    report(Severity::error, deadline.progress.cancelled
                                ? "the time limit for loading was reached before the volume was read"
                                : problem->message);
    return std::nullopt;
  }
  auto& volume = std::get<qnv::Volume>(found);
  volume.values = std::move(values);
  return std::move(volume);
}

vrml::NodeId add_geometry_shape(vrml::SceneGraph& scene, const qnv::Geometry& geometry, const std::string& url) {
  const qnv::Description& description = geometry.description();
  const auto make = [&](vrml::NodeKind kind) { return scene.create(vrml::built_in_node_type(kind)); };
  for (const auto& [key, value] : description.metadata)
    if (key == "title" && !value.empty())
      if (const vrml::NodeId info = make(vrml::NodeKind::world_info)) {
        scene.set<vrml::SFString>(info, "title", vrml::SFString(value));
        scene.add_root(info);
      }
  if (const auto key = color_key_of(description.metadata))
    if (const vrml::NodeId info = make(vrml::NodeKind::world_info)) {
      vrml::MFString lines;
      lines.push_back(vrml::String(color_key_text(*key)));
      scene.set(info, "info", std::move(lines));
      scene.add_root(info);
    }
  const vrml::NodeId shape = make(vrml::NodeKind::shape), appearance = make(vrml::NodeKind::appearance),
                     material = make(vrml::NodeKind::material), qnv = make(vrml::NodeKind::qnv);
  if (!qnv) return qnv;
  vrml::MFString urls;
  urls.push_back(vrml::SFString(url));
  scene.set(qnv, "url", std::move(urls));
  if (geometry.kind() == qnv::Kind::volume) scene.set<vrml::SFString>(qnv, "profile", "VOLUME");
  const Box& box = description.box;
  if (!box.empty()) {
    const glm::dvec3 middle = (glm::dvec3(box.lower) + glm::dvec3(box.upper)) * 0.5;
    scene.set<vrml::SFVec3f>(qnv, "bboxCenter", glm::vec3(description.origin + middle));
    scene.set<vrml::SFVec3f>(qnv, "bboxSize", box.size());
  }
  // Default colour of vectors without a colour.
  if (geometry.kind() == qnv::Kind::surface) {
    const qnv::Rgb8& color = geometry.color();
    const auto part = [](std::uint8_t byte) { return static_cast<float>(byte) / 255; };
    scene.set<vrml::SFColor>(material, "diffuseColor", {part(color.r), part(color.g), part(color.b)});
  }
  scene.set<vrml::SFNode>(appearance, "material", material);
  scene.set<vrml::SFNode>(shape, "appearance", appearance);
  scene.set<vrml::SFNode>(shape, "geometry", qnv);
  scene.add_root(shape);
  return qnv;
}

std::vector<qnv::TransferPoint> transfer_of(const vrml::MFFloat& numbers) {
  constexpr std::size_t kNumbers = 5;
  const auto unit = [](float v) { return v >= 0 ? std::min(v, 1.0f) : 0.0f; };
  const auto byte = [&](float v) { return static_cast<std::uint8_t>(unit(v) * 255 + 0.5f); };
  std::vector<qnv::TransferPoint> points;
  for (std::size_t i = 0; i + kNumbers <= numbers.size(); i += kNumbers)
    points.push_back(
        {unit(numbers[i]), {byte(numbers[i + 1]), byte(numbers[i + 2]), byte(numbers[i + 3])}, unit(numbers[i + 4])});
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return points;
}

std::variant<qnv::Geometry, std::string> inline_vectors(const vrml::SceneGraph& scene, vrml::NodeId node) {
  const auto& words = scene.get<vrml::MFInt32>(node, "vectors");
  const auto& center = scene.get<vrml::SFVec3f>(node, "bboxCenter");
  const auto& size = scene.get<vrml::SFVec3f>(node, "bboxSize");
  if (words.size() < 2) return "the field vectors has no record; expected two numbers per record";
  qnv::Geometry geometry;
  const bool volume = scene.get<vrml::SFString>(node, "profile").view() == "VOLUME";
  if (volume) geometry = qnv::Volume();
  qnv::VectorArrays& arrays = *geometry.arrays();
  qnv::Description& d = arrays.description;
  const float largest = volume ? 1 : std::max({size.x * size.y, size.y * size.z, size.z * size.x});
  const glm::dvec3 middle(center), half = glm::dvec3(size) * 0.5;
  d.origin = qnv::local_origin({middle - half, middle + half});
  d.box.lower = glm::vec3(middle - half - d.origin);
  d.box.upper = glm::vec3(middle + half - d.origin);
  const bool framed = size.x >= 0 && size.y >= 0 && size.z >= 0 && largest > 0 && std::isfinite(largest) &&
                      std::isfinite(d.box.size().x + d.box.size().y + d.box.size().z);
  const qnv::RecordFrame frame = framed ? qnv::frame_for(d.box, largest) : qnv::RecordFrame{};
  if (!framed || !qnv::valid(frame))
    return "the field vectors needs its bounding box; expected bboxCenter and bboxSize";
  const std::size_t count = words.size() / 2;
  std::vector<std::byte> records;
  records.reserve(count * qnv::kRecordBytes);
  for (std::size_t i = 0; i < count * 2; ++i)
    for (int shift = 0; shift < 32; shift += 8)
      records.push_back(static_cast<std::byte>(static_cast<std::uint32_t>(words[i]) >> shift & 255));
  std::vector<std::uint8_t> classes(count);
  arrays.positions.resize(count);
  arrays.normals.resize(count);
  arrays.weights.resize(count);
  qnv::unpack_records(records, frame, arrays.positions.data(), arrays.normals.data(), arrays.weights.data(),
                      classes.data());
  for (const float weight : arrays.weights) d.total += weight;
  d.box = frame.box();
  d.two_sided = true;  // the vectors may not form a closed surface
  d.transfer = transfer_of(scene.get<vrml::MFFloat>(node, "transfer"));
  if (auto* made = geometry.as<qnv::Volume>()) {
    d.spacing = std::max({frame.cell.x, frame.cell.y, frame.cell.z});
    made->classes = std::move(classes);
  } else if (!d.transfer.empty()) {
    for (const std::uint8_t c : classes) arrays.colors.push_back(color_at(d.transfer, static_cast<float>(c) / 255));
  }
  return geometry;
}

}  // namespace gs::app
