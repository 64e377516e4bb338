#include "app/loading/resources/geometry_handler.h"

#include "app/base/local_file.h"
#include "app/base/temporary_file.h"
#include "app/formats/archive/zip_archive.h"
#include "app/formats/flow/flow_mesh.h"
#include "app/formats/qnv/held_streams.h"
#include "app/formats/splats/splats_sog.h"
#include "app/formats/volume/coarser_volume.h"
#include "app/loading/fetch/partial_file.h"
#include "app/loading/resources/splat_levels.h"
#include "net/limits/clock.h"
#include "qnv/codecs/octree/lod/lod_source.h"
#include "qnv/codecs/payloads.h"
#include "qnv/reader/directory_requests.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <variant>

// Decoding of streams, volumes and splat files into vectors.
namespace gs::app {
namespace {

// Time for the first part of the overview of a large volume, and most time for a further part.
constexpr std::chrono::milliseconds kFirstOverview{400}, kMostOverview{4000};

std::string file_name_of(const Found& found) {
  net::Url as_file = found.url;
  as_file.scheme = "file";
  return std::filesystem::path(found.local ? found.path : net::path_of_url(as_file)).filename().string();
}

}  // namespace

GeometryHandler::GeometryHandler(Loading& loading, UrlRequest request, Show show, Progress progress)
    : ResourceHandler(loading, std::move(request)),
      show_(std::move(show)),
      progress_(std::move(progress)),
      decoded_(loading.budget, Resource::vectors) {}

GeometryHandler::~GeometryHandler() { end_requests(); }

// Ends the requests of views for a stream that this handler decodes.
void GeometryHandler::end_requests() {
  if (feed_ && !feed_->takes_bytes()) feed_->finish();
}

bool GeometryHandler::whole_file(const net::MappedFile& file, const std::string& path) {
  way_ = Way::done;
  read_whole(file.bytes(), path);
  return true;
}

bool GeometryHandler::take_parts(const PartsOffer& offer) {
  if (way_ != Way::whole || loading_.options.loss > 0 || cut) return false;
  const std::string name = file_name_of(found_);
  if (!reads_by_parts(name, bytes_)) return false;
  const auto file = std::make_shared<PartialFile>(name, offer, bytes_);
  if (!file->problem().empty()) return false;
  const std::vector<std::byte> front = std::exchange(bytes_, {});
  drop_bytes();
  read_parts(file, front);
  return true;
}

void GeometryHandler::read_parts(const std::shared_ptr<PartialFile>& file, std::span<const std::byte> front) {
  way_ = Way::done;
  parts_ = file;
  read_whole(front, file->path());
  if (!has_more()) warn_of_trouble();
}

bool GeometryHandler::lacks_parts() const { return parts_ && !parts_->trouble().empty(); }

void GeometryHandler::warn_of_trouble() {
  std::string trouble = parts_ ? parts_->trouble() : std::string();
  if (trouble.empty() && array_trouble_) trouble = array_trouble_();
  if (trouble.empty() || trouble == told_trouble_) return;
  warn(": " + trouble);
  told_trouble_ = std::move(trouble);
}

void GeometryHandler::read_whole(std::span<const std::byte> bytes, const std::string& path) {
  const ContentType& type = content_type_of(path, first_bytes(bytes));
  if (is_outline_stream(bytes))
    return warn(": " + path + " is a stream of outlines; expected vectors, or an OutlineGroup for outlines");
  if (!type.remedy.empty()) return warn(": " + path + ": " + type.refusal());
  if (!type.is_geometry()) return warn(": " + path + " is " + std::string(type.name) + "; expected a QNV stream");
  GeometryFile file{path, bytes, cut};
  file.local = found_.local;
  file.to_draw = !loading_.options.whole_surfaces;
  file.origin = {loading_.fetcher.reader_of(found_.origin), file_name_of(found_), loading_.options.component};
  if (!found_.local && loading_.listed && !is_node())
    file.origin.read_beside = loading_.fetcher.reader_of_listed(loading_.listed, found_.origin);
  file.origin.component.served = !found_.local;
  if (!notes_datasets_) file.origin.component.found.reset();
  // The mesh of a flow needs all components.
  if (show_mesh_ && file.origin.component.flow != FlowForm::values)
    file.origin.component.chosen = file.origin.component.magnitude = false;
  if (!is_node()) {
    file.loss = loading_.options.loss;
    file.loss_seed = loading_.options.loss_seed;
  }
  // Views read parts of large containers while another thread loads the rest of the world.
  const bool by_view = (loading_.options.by_view || loading_.options.large_by_view) &&
                       loading_.options.component.flow == FlowForm::values;
  file.origin.component.by_view = by_view;
  file.origin.read_files = by_view && type.content == ContentClass::volume
                               ? loading_.fetcher.files_for_views(found_.origin)
                               : loading_.fetcher.files_of(found_.origin);
  file.origin.list_folder = found_.local ? lister_beside(path) : loading_.fetcher.lister_of(found_.origin, by_view);
  if (parts_) file.origin.need = [parts = parts_](std::span<const ByteSpan> wanted) { return parts->need(wanted); };
  if (type.content == ContentClass::volume) return read_volume(type, file);
  if (by_view && type.read == read_splats_sog_levels && start_splat_levels(type, bytes)) return;
  auto geometry = read_geometry(type, file, loading_.results.diagnostics(), loading_.limit, loading_.budget);
  if (!geometry) return;
  if (auto held = hold_geometry(std::move(*geometry), loading_.budget))
    show_(std::move(held));
  else
    give_up(Resource::vectors);
}

bool GeometryHandler::start_splat_levels(const ContentType& type, std::span<const std::byte> bytes) {
  if (!place_ || is_node() || is_zip(bytes)) return false;
  auto parsed = parse_sog_levels(bytes, loading_.budget);
  if (const auto* problem = std::get_if<SogLevelsProblem>(&parsed)) {
    loading_.results.report(Severity::error, found_.path, problem->location, problem->message);
    return true;
  }
  const auto levels = std::make_shared<SplatLevels>(
      loading_, SplatLevels::Source{std::move(std::get<SogLevels>(parsed)), &type, found_.path, found_.origin,
                                    found_.local, loading_.options.by_view});
  auto first = levels->read_first();
  if (!first) return true;
  show_(first);
  levels->show_by([&loading = loading_, place = place_()](std::shared_ptr<const qnv::Geometry> geometry) {
    loading.results.add(ResourceUpdates::Geometry{place, {}, std::move(geometry)});
  });
  loading_.results.add(levels->feed());
  loading_.fetcher.network().add_stream(levels);
  return true;
}

void GeometryHandler::read_volume(const ContentType& type, const GeometryFile& file) {
  Diagnostics diagnostics;
  auto source = open_volume_source(type, file, diagnostics, loading_.budget);
  const bool is_array = source && file.origin.component.by_view && start_array(*source);
  if (source && file.origin.component.by_view && !is_array && is_large(*source)) {
    // Read as a whole, the finest level of an image may be too large.
    GeometryFile whole = file;
    whole.origin.component.by_view = false;
    if (!source->coarser.empty()) source = open_volume_source(type, whole, diagnostics, loading_.budget);
  }
  for (Diagnostic one : diagnostics.entries()) {
    // Users cannot choose the datasets of nodes.
    if (one.severity == Severity::note && is_node()) continue;
    if (one.file == file.path) one.file = found_.path;  // not that of a temporary file
    loading_.results.diagnostics().add(std::move(one));
  }
  if (!source || show_flow(*source, file.origin.component)) return;
  if (is_array) return;
  // Without views, only the finest version counts.
  if (loading_.options.by_view)
    add_coarser(*source);
  else
    source->coarser.clear();
  for (qnv::VolumeSource& version : source->coarser) versions_.push_back(std::move(version));
  source->coarser.clear();
  versions_.push_back(std::move(*source));
  while (has_more() && !show_next_version()) {
  }
}

bool GeometryHandler::show_flow(const qnv::VolumeSource& source, const VoxelComponent& choice) {
  if (!show_mesh_ || choice.flow == FlowForm::values) return false;
  Deadline deadline(loading_.limit);
  MeshAsset mesh =
      flow_mesh(source, choice, found_.path, deadline.progress, loading_.budget, loading_.results.diagnostics());
  if (mesh.empty()) return false;
  show_mesh_(std::move(mesh));
  return true;
}

void GeometryHandler::read_more() {
  if (array_ && versions_.empty())
    read_array();
  else
    (void)show_next_version();
}

bool GeometryHandler::is_large(const qnv::VolumeSource& source) const {
  // Smaller volumes are quickly read as a whole. Those in containers on servers take a request per chunk.
  constexpr std::uint64_t kLocalVoxels = std::uint64_t{1} << 28, kServedVoxels = std::uint64_t{1} << 24;
  return qnv::voxel_count(source.layout) >= (found_.local ? kLocalVoxels : kServedVoxels);
}

bool GeometryHandler::start_array(qnv::VolumeSource& source) {
  constexpr std::uint64_t kFirstVoxels = std::uint64_t{1} << 20;
  if (!is_large(source)) return false;
  array_trouble_ = source.trouble;
  // Drawing has the time limit of loading, too, and needs some of it itself.
  constexpr double kPartOfLimit = 0.6;
  array_ = hold_array(source, loading_.budget,
                      std::chrono::milliseconds(static_cast<std::int64_t>(
                          kPartOfLimit * 1000 * std::clamp(loading_.options.timeout_seconds, 0.1, 1e6))));
  if (!array_) return false;
  if (const auto key = found_.local && source.coarser.empty()
                           ? overview_key(found_.path, loading_.options.component, source.layout)
                           : std::nullopt) {
    array_key_ = *key;
    if (auto samples = overviews().find(array_key_); samples && array_->restore_overview(std::move(*samples)))
      array_key_.clear();
  }
  array_patience_ = kFirstOverview;
  // A server may take long for the overview, so the file's own coarse versions come first.
  if (!found_.local && loading_.options.by_view)
    for (qnv::VolumeSource& version : source.coarser)
      if (qnv::voxel_count(version.layout) < kFirstVoxels) versions_.push_back(std::move(version));
  if (versions_.size() > 1) versions_.erase(versions_.begin() + 1, versions_.end());
  if (versions_.empty() || !show_next_version()) read_array();
  return true;
}

OverviewCache GeometryHandler::overviews() const {
  return OverviewCache(overview_folder(loading_.options.cache_folder));
}

void GeometryHandler::read_array() {
  const bool shows = array_->read_overview(array_patience_, [this] { return loading_.limit.over(); });
  array_patience_ = std::min(2 * array_patience_, kMostOverview);
  const bool ends = array_->has_overview() || loading_.limit.over();
  if (array_->has_whole_overview() && !array_key_.empty()) overviews().keep(array_key_, array_->kept_overview());
  if (shows) show_(std::make_shared<const qnv::Geometry>(volume_of(array_)));
  if (!ends) return;
  warn_of_trouble();
  if (!shows) warn(": the volume has no values that can be read");
  array_.reset();
}

bool GeometryHandler::show_next_version() {
  const qnv::VolumeSource source = std::move(versions_.front());
  versions_.pop_front();
  auto geometry = read_gradients(source, found_.path, !found_.local, loading_.results.diagnostics(), loading_.limit,
                                 loading_.budget);
  if (!geometry) return false;
  auto* const volume = geometry->as<qnv::Volume>();
  // Pictures are shown as slices, which need no gradients.
  const auto& sides = source.layout.dimensions;
  const bool is_solid = std::all_of(sides.begin(), sides.end(), [](std::uint32_t side) { return side > 1; });
  if (!has_more() && volume && volume->empty() && is_solid)
    warn(": the voxels of the volume have one value, so it is invisible; slices (key V) show the value");
  if (has_more() && volume && volume->values) {
    // These are values of fewer voxels, with an unknown error.
    const auto coarse = std::make_shared<qnv::VolumeValues>(*volume->values);
    coarse->exact = false;
    coarse->error.reset();
    volume->values = coarse;
  }
  auto held = hold_geometry(std::move(*geometry), loading_.budget);
  if (!held) {
    versions_.clear();
    give_up(Resource::vectors);
    return true;
  }
  show_(std::move(held));
  return true;
}

void GeometryHandler::give_up(Resource resource) {
  way_ = Way::done;
  end_requests();
  drop_bytes();
  loading_.results.report(Severity::error, found_.path, {},
                          loading_.budget->refusal(resource) + "; all or the finer vectors are left out");
}

bool GeometryHandler::count_decoded() {
  const std::uint64_t bytes = decoder_->vectors() * kDecodedBytes;
  return bytes <= decoded_.amount() || decoded_.grow(bytes - decoded_.amount());
}

void GeometryHandler::receive(std::span<const std::byte> bytes) {
  if (way_ == Way::done) return;
  if (way_ == Way::pushed) return feed_->push(bytes);
  if (way_ == Way::decoded) {
    (void)decoder_->push(bytes);
    return show_more();
  }
  if (!keep(bytes)) return give_up(Resource::files);
  if (way_ == Way::unknown) choose_way();
}

// Selects the decoder of the resource. QNV streams are shown while they are received. Other files are read when they
// are complete.
void GeometryHandler::choose_way() {
  if (!qnv::is_stream(bytes_)) {
    if (bytes_.size() >= kTypeBytes) way_ = Way::whole;
    return;
  }
  // The reader of whole files simulates the loss. For cells, the transport does.
  if (loading_.options.loss > 0 && !is_node() && found_.url.scheme != "cells") {
    way_ = Way::whole;
    return;
  }
  std::size_t header_bytes = 0;
  bool need_more = false;
  const auto header = qnv::decode_header(bytes_, header_bytes, need_more);
  if (need_more) return;
  if (!std::holds_alternative<qnv::StreamHeader>(header)) {
    way_ = Way::whole;  // the reader of whole files gives the better error message
    return;
  }
  const auto& known = std::get<qnv::StreamHeader>(header);
  const qnv::PayloadReader reader = qnv::row_of(known).reader;
  if (reader == qnv::PayloadReader::polygons) {
    way_ = Way::whole;  // the reader of whole files reports that these are polygons
    return;
  }
  if (reader == qnv::PayloadReader::levels) {
    auto begun = qnv::LodStream::begin(bytes_);
    if (auto* stream = std::get_if<std::unique_ptr<qnv::LodStream>>(&begun)) {
      way_ = Way::pushed;
      start_levels(hold_levels(std::move(*stream), loading_.budget, true));
      bytes_ = {};
      return;
    }
  }
  if (known.payload == qnv::Payload::gaussians && !loading_.options.whole_surfaces) {
    auto begun = qnv::SplatStream::begin(bytes_);
    if (auto* stream = std::get_if<std::unique_ptr<qnv::SplatStream>>(&begun)) {
      way_ = Way::pushed;
      start_cuts(hold_cuts(std::move(*stream), loading_.budget, true));
      bytes_ = {};
      return;
    }
  }
  if (known.steps.times.empty() && qnv::BrickVolume::suits(known, most_decoded_vectors(*loading_.budget))) {
    BrickShare share(loading_.budget, true);
    auto begun = qnv::BrickVolume::begin(bytes_, share.limits);
    if (auto* const volume = std::get_if<0>(&begun)) {
      way_ = Way::pushed;
      start_bricks(hold_bricks(std::move(*volume), std::move(share)));
      bytes_ = {};
      return;
    }
  }
  start_decoder(known);
}

void GeometryHandler::start_decoder(const qnv::StreamHeader& header) {
  way_ = Way::decoded;
  if (loading_.options.by_view)
    add_feed(std::make_shared<StreamFeed>(std::make_shared<qnv::DirectoryRequests>(header),
                                          [waker = loading_.waker] { waker->wake(); }));
  const VoxelComponent& component = loading_.options.component;
  const qnv::ShownStep step = component.step.value_or(qnv::ShownStep());
  // No view shows other steps, so it need not know the requests.
  if (loading_.options.one_step && !feed_ && !header.steps.times.empty())
    feed_ = std::make_shared<StreamFeed>(
        std::make_shared<qnv::DirectoryRequests>(header, qnv::step_number(step, header.steps.times)),
        [waker = loading_.waker] { waker->wake(); });
  decoder_ = std::make_unique<qnv::StreamDecoder>(most_decoded_vectors(*loading_.budget));
  decoder_->show({component.index, component.magnitude, component.chosen, step});
  (void)decoder_->push(std::exchange(bytes_, {}));
  show_records(false);
}

void GeometryHandler::add_feed(std::shared_ptr<StreamFeed> feed) {
  feed_ = std::move(feed);
  loading_.results.add(feed_);
}

void GeometryHandler::start_levels(std::shared_ptr<qnv::LodStream> stream) {
  add_feed(std::make_shared<StreamFeed>(stream, [waker = loading_.waker] { waker->wake(); }));
  show_(std::make_shared<const qnv::Geometry>(qnv::OctreeSplats(std::move(stream))));
}

void GeometryHandler::start_cuts(std::shared_ptr<qnv::SplatStream> stream) {
  add_feed(std::make_shared<StreamFeed>(stream, [waker = loading_.waker] { waker->wake(); }));
  show_(std::make_shared<const qnv::Geometry>(gaussians_of(std::move(stream))));
}

void GeometryHandler::start_bricks(const std::shared_ptr<qnv::BrickVolume>& volume) {
  add_feed(std::make_shared<StreamFeed>(volume, [waker = loading_.waker] { waker->wake(); }));
  show_(std::make_shared<const qnv::Geometry>(volume_of(volume)));
}

// Shows newly decoded vectors, unless they exceed the memory budget.
void GeometryHandler::show_more() {
  if (count_decoded() && !decoder_->full()) return show_records(false);
  show_records(true);
  give_up(Resource::vectors);
}

// Shows the vectors again if the pace allows it and their number or revision has grown by a quarter, because each time
// costs linear work. The revision also grows when the vectors of a surface only move.
void GeometryHandler::show_records(bool last) {
  // Counting the vectors of a mesh needs the mesh, so only its revision is compared.
  const bool mesh = decoder_->mesh().shown();
  const std::size_t vectors = mesh ? shown_ + 1 : decoder_->vectors();
  const std::uint64_t revision = decoder_->revision();
  const net::Instant began = net::clock_now();
  const bool more = vectors >= shown_ + shown_ / 4 + 1000, finer = revision > shown_revision_ + shown_revision_ / 4;
  const bool exact = decoder_->mesh().final && !shown_exact_;
  if (vectors == 0 || revision == shown_revision_ || (!last && !more && !finer && !exact && !pace_.due(began))) return;
  shown_exact_ = decoder_->mesh().final;
  shown_ = vectors;
  shown_revision_ = revision;
  qnv::Geometry geometry = loading_.options.whole_surfaces ? decoder_->geometry() : decoder_->geometry_to_draw();
  if (feed_ && !last) geometry.base().requests = feed_->requests();
  show_(std::make_shared<const qnv::Geometry>(std::move(geometry)));
  pace_.made(began, net::clock_now());
}

void GeometryHandler::end(const std::optional<std::string>& problem) {
  if (problem) warn(": " + *problem + "; the received part is shown");
  if (way_ == Way::done) return;
  const bool part = cut || problem;
  if (way_ == Way::pushed) {
    feed_->finish();
  } else if (way_ == Way::decoded) {
    // If views choose the chunks, the front of the stream ends inside a chunk, which is no problem.
    if (!part && !by_chunks_) decoder_->finish();
    report_problems(decoder_->problems(), Severity::warning);
    if (const std::size_t invalid = decoder_->refused_chunks() + damaged_chunks_; invalid > 0)
      loading_.results.report(Severity::warning, found_.path, {},
                              std::to_string(invalid) + " invalid chunks are left out");
    show_records(true);
    end_requests();
    decoder_.reset();
  } else {
    cut = part;
    read_bytes();
  }
}

void GeometryHandler::read_bytes() {
  const std::string name = found_.local ? found_.path : file_name_of(found_);
  const ContentType& type = content_type_of(name, first_bytes(bytes_));
  if (type.content != ContentClass::volume || found_.local) {
    read_whole(bytes_, name);
  } else {
    // Volumes are read from a file, slice by slice. Write the bytes to a temporary file.
    const TemporaryFile file(name, bytes_);
    if (file.problem().empty())
      read_whole(bytes_, file.path());
    else
      loading_.results.report(Severity::error, found_.path, {}, file.problem());
  }
  bytes_ = {};
}

void GeometryHandler::receive_piece(const net::CellEvent& event) {
  if (way_ == Way::pushed) return feed_->add_loose(event.name.chunk, event.bytes);
  if (way_ != Way::decoded) return;
  by_chunks_ = true;
  if (event.records) {
    // The records keep their offset in the chunk. The records before that offset may be received later or never.
    const auto head = std::span(event.head).subspan(std::min(event.head.size(), qnv::kChunkHeaderBytes));
    std::vector<std::byte> payload(head.begin(), head.end());
    payload.resize(head.size() + event.offset);
    payload.insert(payload.end(), event.bytes.begin(), event.bytes.end());
    const qnv::ByteRange missing{head.size(), head.size() + event.offset};
    decoder_->add(qnv::ChunkType::records, payload, std::span(&missing, event.offset > 0 ? 1 : 0));
  } else if (const auto chunk = qnv::sound_chunk(event.bytes); std::holds_alternative<qnv::SoundChunk>(chunk)) {
    const auto& sound = std::get<qnv::SoundChunk>(chunk);
    decoder_->add(sound.type, sound.payload);
  } else {
    ++damaged_chunks_;
  }
  show_more();
}

void GeometryHandler::report_problems(const std::vector<qnv::StreamProblem>& problems, Severity severity) {
  for (const qnv::StreamProblem& problem : problems)
    loading_.results.report(severity, found_.path, {},
                            "byte " + std::to_string(problem.offset) + ": " + problem.message);
}

}  // namespace gs::app
