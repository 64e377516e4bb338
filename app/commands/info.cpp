#include "app/commands/info.h"

#include "app/base/console.h"
#include "app/base/local_file.h"
#include "app/commands/common/shared.h"
#include "app/commands/common/value_sample.h"
#include "app/commands/common/vectors_of.h"
#include "app/encode/surface_triangles.h"
#include "app/formats/content_types.h"
#include "app/formats/datasets/arrays/dataset_tree.h"
#include "app/formats/datasets/dataset_formats.h"
#include "app/formats/foreign_types.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/formats/splats/splats.h"
#include "app/formats/volume/confined/confined_list.h"
#include "base/gzip.h"
#include "base/json_value.h"
#include "net/base/url_signature.h"
#include "net/files/file.h"
#include "qnv/codecs/displaced/surface.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/gaussians/splat_cluster.h"
#include "qnv/codecs/gaussians/splat_steps.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/outlines/outline_stream.h"
#include "qnv/codecs/payloads.h"
#include "qnv/codecs/values/cluster.h"
#include "qnv/codecs/values/component_number.h"
#include "qnv/codecs/values/labels/label_runs.h"
#include "qnv/reader/stream_decoder.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

JsonValue fact_of(const glm::dvec3& p) { return JsonValue::list({p.x, p.y, p.z}); }

void put_box(JsonValue& facts, const glm::dvec3& lower, const glm::dvec3& upper) {
  if (lower.x <= upper.x) facts.put("box", JsonValue::named({{"lower", fact_of(lower)}, {"upper", fact_of(upper)}}));
}

void put_metadata(JsonValue& facts, const std::vector<std::pair<std::string, std::string>>& metadata) {
  JsonValue all = JsonValue::named();
  for (const auto& [key, value] : metadata) all.put(key, value);
  if (!all.empty()) facts.put("metadata", std::move(all));
}

// Returns a colour as "#rrggbb".
std::string written(const qnv::Rgb8& color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<unsigned>(color.r), static_cast<unsigned>(color.g),
                static_cast<unsigned>(color.b));
  return text;
}

void put_vectors(JsonValue& facts, const qnv::Geometry& geometry) {
  const qnv::VectorView vectors(geometry);
  const qnv::Description& d = vectors.description;
  const bool volume = vectors.kind == qnv::Kind::volume;
  facts.put("kind", volume ? "volume" : geometry.as<qnv::Gaussians>() ? "Gaussians" : "surface");
  facts.put("vectors", vectors.size());
  facts.put(volume ? "magnitude" : "area", d.total);
  if (volume) {
    facts.put("spacing", d.spacing);
    facts.put("values", JsonValue::list({d.value_range.first, d.value_range.second}));
    facts.put("transfer_points", d.transfer.size());
  } else {
    facts.put("two_sided", d.two_sided);
    facts.put("colors", vectors.colors.empty() ? "one" : "of each vector");
    if (vectors.colors.empty()) facts.put("color", written(vectors.color));
  }
  put_box(facts, d.origin + glm::dvec3(d.box.lower), d.origin + glm::dvec3(d.box.upper));
  if (d.origin != glm::dvec3(0)) facts.put("local_origin", fact_of(d.origin));
}

// Received parts of one level of an octree, or of one layer.
struct Level {
  std::size_t chunks = 0, bytes = 0, vectors = 0;
};

// Sums up the chunks of a stream per level. Counts vectors only in chunks of records, which store their number.
std::map<int, Level> levels_of(const qnv::StreamHeader& stream, std::span<const std::byte> bytes) {
  std::map<int, Level> levels;
  qnv::StreamReader reader;
  std::optional<qnv::values::BlockLayout> blocks;
  if (stream.payload == qnv::Payload::values)
    blocks.emplace(stream.grid.dimensions, qnv::values::level_count(stream.grid.dimensions));
  (void)reader.push(bytes, [&](qnv::ChunkType type, std::span<const std::byte> payload, std::uint64_t) {
    int level = -1;
    std::size_t vectors = 0;
    if (type == qnv::ChunkType::packed) {
      const auto read = qnv::read_cluster_header(payload);
      if (const auto* header = std::get_if<qnv::ClusterHeader>(&read)) level = header->level + header->levels;
    } else if (type == qnv::ChunkType::displaced) {
      const auto header = qnv::displaced::decode_cluster_header(payload);
      if (header) level = header->kind == qnv::displaced::ClusterHeader::Kind::base ? 0 : header->level;
    } else if (type == qnv::ChunkType::piece) {
      level = 0;
    } else if (type == qnv::ChunkType::values && blocks) {
      // The first number counts the blocks of all components.
      const auto part = qnv::values::without_component(payload, blocks->count());
      const std::size_t parts = stream.grid.components * std::max<std::size_t>(stream.steps.times.size(), 1);
      const bool known = part && part->component < parts;
      const auto cluster = known ? qnv::values::parse_cluster(part->payload, true) : std::nullopt;
      if (cluster) level = blocks->place(cluster->block).level - 1;
    } else if (type == qnv::ChunkType::labels) {
      if (const auto run = qnv::values::parse_label_run(payload)) level = run->level;
    } else if (type == qnv::ChunkType::gaussians) {
      if (const auto cluster = qnv::gaussians::parse_cluster(payload)) level = static_cast<int>(cluster->head.level);
    } else if (type == qnv::ChunkType::records && payload.size() >= qnv::kRecordsHeaderBytes) {
      level = std::to_integer<int>(payload.front());
      vectors = (payload.size() - qnv::kRecordsHeaderBytes) / qnv::kRecordBytes;
    }
    if (level < 0) return;
    Level& l = levels[level];
    ++l.chunks;
    l.bytes += qnv::kChunkHeaderBytes + payload.size();
    l.vectors += vectors;
  });
  return levels;
}

const char* name_of(qnv::VoxelType type) {
  static constexpr const char* kNames[] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"};
  return kNames[static_cast<std::size_t>(type)];
}

// Adds the number of steps of a time series, and their times: the first and the last one of many.
void put_steps(JsonValue& facts, const std::vector<double>& times) {
  constexpr std::size_t kMany = 16;
  facts.put("steps", times.size());
  if (times.size() > kMany) {
    facts.put("first_time", times.front());
    facts.put("last_time", times.back());
    return;
  }
  JsonValue list = JsonValue::list();
  for (const double time : times) list.add(time);
  facts.put("times", std::move(list));
}

// Adds the grid of a stream of values, and the error of the received part.
void put_values(JsonValue& facts, const qnv::StreamHeader& header, const qnv::Geometry& geometry) {
  const auto& [x, y, z] = header.grid.dimensions;
  facts.put("dimensions", JsonValue::list({x, y, z}));
  facts.put("type_of_voxels", name_of(header.grid.stored));
  if (header.grid.components > 1) facts.put("components", std::size_t{header.grid.components});
  if (header.grid.colors) facts.put("colors", header.grid.luma ? "brightness and differences" : "red, green, blue");
  if (!header.steps.times.empty()) put_steps(facts, header.steps.times);
  if (header.grid.labels) facts.put("labels", header.grid.palette.size());
  const auto* volume = geometry.as<qnv::Volume>();
  if (!volume || !volume->values) return;
  const qnv::VolumeValues& values = *volume->values;
  facts.put("level_of_values", values.level);
  facts.put("exact", values.exact);
  if (values.error) facts.put("error", *values.error);
  if (values.wrong) facts.put("wrong_labels", *values.wrong);
  if (values.rms) facts.put("error_rms", *values.rms);
}

std::string_view name_of(qnv::GaussianCoding::Version version) {
  using Version = qnv::GaussianCoding::Version;
  return version == Version::plain ? "plain" : version == Version::trained ? "trained" : "tuned";
}

// Adds the properties of a stream of Gaussians, and its errors at the end: for important Gaussians, and for all.
void put_gaussians(JsonValue& facts, const qnv::StreamHeader& header) {
  const qnv::gaussians::SplatErrors errors = qnv::gaussians::splat_errors(header.gaussians);
  const auto both = [](const std::array<double, 2>& values) { return JsonValue::list({values[0], values[1]}); };
  facts.put("harmonics", header.gaussians.degree);
  facts.put("antialiased", header.gaussians.antialiased);
  facts.put("coding", name_of(header.gaussians.version));
  facts.put("errors_at_the_end", JsonValue::named({{"position_in_deviations", both(errors.place)},
                                                   {"deviation", both(errors.scale)},
                                                   {"shortest_deviation", both(errors.thin)},
                                                   {"opacity", both(errors.opacity)},
                                                   {"color", both(errors.color)}}));
}

void put_levels(JsonValue& facts, const qnv::StreamHeader& header, const qnv::VectorView& shown,
                std::span<const std::byte> bytes) {
  const bool octree = header.payload == qnv::Payload::packed, layers = header.payload == qnv::Payload::records;
  std::map<int, Level> levels = levels_of(header, bytes);
  const auto level_of = [&](const qnv::Cell& cell) {
    return static_cast<int>(std::lround(std::log2(header.cube.edge / cell.edge)));
  };
  // For octrees, count the voxels that no finer voxels have replaced.
  if (octree)
    for (const qnv::Cell& cell : shown.cells)
      if (cell.edge > 0) ++levels[level_of(cell)].vectors;
  JsonValue list = JsonValue::list();
  for (const auto& [level, l] : levels) {
    JsonValue fact = JsonValue::named({{layers ? "layer" : "level", level}, {"chunks", l.chunks}, {"bytes", l.bytes}});
    if (octree || layers) fact.put(octree ? "shown" : "vectors", l.vectors);
    list.add(std::move(fact));
  }
  facts.put("levels", std::move(list));
}

bool describe_outlines(JsonValue& facts, std::span<const std::byte> bytes, const std::string& path, const Budget&) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  qnv::OutlineDecoder decoder;
  for (auto rest = bytes; !rest.empty(); rest = rest.subspan(std::min(kPiece, rest.size()))) {
    if (!decoder.push(rest.first(std::min(kPiece, rest.size())))) break;
    (void)decoder.take();  // the polygons are not needed, only their number
  }
  decoder.finish();
  const qnv::StreamHeader* header = decoder.header();
  JsonValue problems = JsonValue::list();
  for (const qnv::StreamProblem& problem : decoder.problems()) {
    const std::string text = "byte " + std::to_string(problem.offset) + ": " + problem.message;
    problems.add(text);
    if (!header) complain("%s: error: %s", path.c_str(), text.c_str());
  }
  if (!header) return false;
  facts.put("payload", "outlines");
  facts.put("groups", header->outlines.groups);
  facts.put("outline_polygons", decoder.outline_polygons());
  facts.put("inner_polygons", decoder.inner_polygons());
  facts.put("polygons_at_full_detail", header->vectors);
  facts.put("appearances", header->outlines.appearances.size());
  facts.put("step", header->outlines.positions.step());
  put_box(facts, header->description.box.lower, header->description.box.upper);
  facts.put("chunks", header->chunks);
  facts.put("directory_entries", decoder.directory().size());
  facts.put("damaged_chunks", decoder.refused_chunks());
  facts.put("damaged_polygons", decoder.refused_records());
  put_metadata(facts, header->description.metadata);
  if (!problems.empty()) facts.put("problems", std::move(problems));
  return true;
}

bool describe_stream(JsonValue& facts, std::span<const std::byte> bytes, const std::string& path,
                     const Budget& budget) {
  qnv::StreamDecoder decoder(most_decoded_vectors(budget));
  (void)decoder.push(bytes);
  decoder.finish();
  JsonValue problems = JsonValue::list();
  for (const qnv::StreamProblem& problem : decoder.problems())
    problems.add("byte " + std::to_string(problem.offset) + ": " + problem.message);
  const qnv::StreamHeader* header = decoder.header();
  if (!header) {
    for (const qnv::StreamProblem& problem : decoder.problems())
      complain("%s: error: byte %llu: %s", path.c_str(), static_cast<unsigned long long>(problem.offset),
               problem.message.c_str());
    return false;
  }
  // A volume larger than memory is described at a coarser level, which the facts name.
  if (decoder.full() && header->payload != qnv::Payload::values)
    complain("%s: error: vectors need %s; finer ones are not counted", path.c_str(),
             budget.refusal(Resource::vectors).c_str());
  const qnv::Geometry geometry = decoder.geometry();
  const auto* surface = geometry.as<qnv::IndexedMesh>();
  const std::size_t triangles = surface ? surface->triangles.size() / 3 : 0;
  facts.put("payload", std::string(qnv::row_of(header->payload).name));
  put_vectors(facts, geometry);
  facts.put("vectors_at_full_detail", header->vectors);
  facts.put("chunks", header->chunks);
  facts.put("palette", header->palette.size());
  facts.put("directory_entries", decoder.directory().size());
  facts.put("damaged_chunks", decoder.refused_chunks() + decoder.problems().size());
  if (header->parity) facts.put("restored_chunks", decoder.restored_chunks());
  const qnv::MeshProgress mesh = decoder.mesh();
  if (mesh.bytes > 0) {
    JsonValue tail = JsonValue::named({{"bytes", mesh.bytes}, {"come", mesh.received}});
    if (mesh.whole) {
      tail.put("bits", mesh.bits);
      tail.put("triangles", triangles);
    } else if (mesh.partly) {
      tail.put("triangles", mesh.all_triangles);
      tail.put("triangles_come", mesh.triangles);
    }
    if (mesh.texture_bytes > 0)
      tail.put("picture", JsonValue::named({{"bytes", mesh.texture_bytes}, {"come", mesh.texture_received}}));
    facts.put("exact", std::move(tail));
  }
  if (mesh.growing)
    facts.put("progressive",
              JsonValue::named(
                  {{"bits", mesh.bits}, {"vertices", mesh.vertices}, {"triangles", triangles}, {"whole", mesh.final}}));
  if (header->payload == qnv::Payload::values) put_values(facts, *header, geometry);
  if (header->payload == qnv::Payload::gaussians) put_gaussians(facts, *header);
  put_levels(facts, *header, geometry, bytes);
  put_metadata(facts, header->description.metadata);
  if (!problems.empty()) facts.put("problems", std::move(problems));
  return true;
}

void describe_volume(JsonValue& facts, const qnv::VolumeSource& volume, const ReadingTime& time) {
  const qnv::VolumeLayout& layout = volume.layout;
  if (!volume.times.empty()) put_steps(facts, volume.times);
  facts.put("dimensions", JsonValue::list({layout.dimensions[0], layout.dimensions[1], layout.dimensions[2]}));
  facts.put("type_of_voxels", std::string(name_of(layout.type)) + (layout.big_endian ? "be" : ""));
  if (layout.labels) facts.put("labels", true);
  facts.put("axes", JsonValue::list({fact_of(layout.axes[0]), fact_of(layout.axes[1]), fact_of(layout.axes[2])}));
  facts.put("origin", fact_of(layout.base + layout.origin));
  const ValueSample sample = sample_values(volume, time);
  if (sample.least <= sample.most) facts.put("values", JsonValue::list({sample.least, sample.most}));
  if (sample.missing > 0) facts.put("missing_voxels", sample.missing);
  if (qnv::check(layout) || sample.voxels < qnv::voxel_count(layout)) facts.put("voxels_read", sample.voxels);
  put_metadata(facts, layout.metadata);
}

JsonValue dataset_list(std::span<const DatasetEntry> entries) {
  JsonValue list = JsonValue::list();
  for (const DatasetEntry& entry : entries) {
    JsonValue shape = JsonValue::list();
    for (const std::uint64_t size : entry.shape) shape.add(size);
    JsonValue one = JsonValue::named(
        {{"path", entry.path}, {"shape", std::move(shape)}, {"type", entry.type}, {"unit", entry.unit}});
    if (!entry.axes.empty()) one.put("axes", entry.axes);
    if (entry.form != DatasetForm::nothing) one.put("shown_as", entry.form == DatasetForm::volume ? "volume" : "mesh");
    if (!entry.note.empty()) one.put("note", entry.note);
    list.add(std::move(one));
  }
  return list;
}

// Returns the datasets of a file as a tree, for users.
std::vector<std::string> dataset_tree(std::span<const DatasetEntry> entries) {
  std::vector<std::string> lines{"datasets"};
  std::string folder;
  for (const DatasetEntry& entry : entries) {
    const std::string in = folder_of_path(entry.path);
    if (in != folder) lines.push_back("  " + shortened(in, 120));
    folder = in;
    constexpr std::size_t kNames = 32, kTypes = 14;
    std::string line = "    " + shortened(name_of_path(entry.path), 80);
    line.resize(std::max(line.size() + 1, kNames), ' ');
    line += shortened(entry.type, 60);
    line.resize(std::max(line.size() + 1, kNames + kTypes), ' ');
    line += shape_text(entry.shape);
    if (!entry.unit.empty()) line += "  " + shortened(entry.unit, 40);
    if (!entry.axes.empty()) line += "  (" + shortened(entry.axes, 80) + ')';
    if (!entry.note.empty()) line += "  " + shortened(entry.note, 120);
    lines.push_back(std::move(line));
  }
  return lines;
}

void put_notes(JsonValue& facts, const Diagnostics& diagnostics) {
  JsonValue notes = JsonValue::list();
  for (const Diagnostic& one : diagnostics.entries())
    if (one.severity == Severity::note) notes.add(one.message);
  if (!notes.empty()) facts.put("notes", std::move(notes));
}

// Adds the statements of an X3D world.
void put_x3d(JsonValue& facts, const vrml::SceneGraph& scene) {
  const vrml::X3DStatements& x3d = scene.x3d();
  if (scene.language() != vrml::Language::x3d) return;
  facts.put("version", std::to_string(scene.version() / 10) + '.' + std::to_string(scene.version() % 10));
  if (!x3d.profile.empty()) facts.put("profile", x3d.profile);
  JsonValue components = JsonValue::list(), units = JsonValue::list();
  for (const vrml::X3DStatements::Component& one : x3d.components)
    components.add(one.name + ':' + std::to_string(one.level));
  if (!components.empty()) facts.put("components", std::move(components));
  for (const vrml::X3DStatements::Unit& one : x3d.units)
    units.add(JsonValue::named({{"category", one.category}, {"name", one.name}, {"factor", one.factor}}));
  if (!units.empty()) facts.put("units", std::move(units));
  // Several METAs may have one name.
  std::vector<std::pair<std::string, std::string>> metadata;
  for (const vrml::X3DStatements::Meta& one : x3d.metas) {
    const auto same =
        std::find_if(metadata.begin(), metadata.end(), [&](const auto& m) { return m.first == one.name; });
    if (same == metadata.end())
      metadata.emplace_back(one.name, one.content);
    else
      same->second += "; " + one.content;
  }
  put_metadata(facts, metadata);
}

void describe_world(JsonValue& facts, const OpenedSurface& opened) {
  const SurfaceSummary summary = summarize_surface(opened.list);
  const LoadedWorld& world = opened.world;
  std::size_t vectors = 0;
  for (const auto& [node, geometry] : world.geometries) {
    const auto* octree = geometry->as<qnv::OctreeSplats>();
    const auto* gaussians = geometry->as<qnv::Gaussians>();
    if (gaussians && gaussians->stream)
      vectors += static_cast<std::size_t>(gaussians->stream->header().vectors);
    else
      vectors += octree ? static_cast<std::size_t>(octree->stream->header().vectors) : geometry->size();
  }
  facts.put("title", world.title);
  put_x3d(facts, *world.scene);
  facts.put("nodes", world.scene->nodes().count());
  facts.put("shapes", opened.list.items.size() + opened.list.splats.size());
  facts.put("triangles", summary.triangles);
  facts.put("vectors", vectors);
  facts.put("viewpoints", opened.list.viewpoints.size());
  facts.put("images", world.images.size());
  facts.put("textured", summary.textured);
  facts.put("two_sided", summary.two_sided);
  if (!opened.list.bounds.empty()) put_box(facts, opened.list.bounds.lower, opened.list.bounds.upper);
  facts.put("errors", world.diagnostics.errors());
  facts.put("warnings", world.diagnostics.warnings());
  put_notes(facts, world.diagnostics);
}

void describe_input(JsonValue& facts, const OpenedInput& input, const ReadingTime& time) {
  facts.put("type", input.type);
  if (const auto* volume = std::get_if<qnv::VolumeSource>(&input.content)) {
    describe_volume(facts, *volume, time);
  } else if (const auto* geometry = std::get_if<qnv::Geometry>(&input.content)) {
    put_vectors(facts, *geometry);
    auto metadata = geometry->description().metadata;
    // Gaussians are kept as they are. These texts describe what discs instead of them would lose.
    if (const auto* gaussians = geometry->as<qnv::Gaussians>()) {
      facts.put("harmonics", gaussians->degree);
      facts.put("antialiased", gaussians->antialiased);
      std::erase_if(metadata,
                    [](const auto& pair) { return pair.first == kSplatsAsDiscs || pair.first == kThickSplats; });
    }
    put_metadata(facts, metadata);
  } else if (const auto* mesh = std::get_if<MeshStream>(&input.content)) {
    facts.put("faces", mesh->faces);
  } else {
    describe_world(facts, *std::get<std::unique_ptr<OpenedSurface>>(input.content));
  }
}

// Describes a file of a server.
std::optional<JsonValue> describe_url(const InfoCommand& options, const std::string& url, const ReadingTime& time) {
  const auto input = open_input(options, url, MeshForm::world);
  if (!input) return std::nullopt;
  JsonValue facts = JsonValue::named({{"file", net::without_signature(url)}, {"type", ""}, {"bytes", input->bytes}});
  describe_input(facts, *input, time);
  return facts;
}

void print_report(const InfoCommand& options, const JsonValue& facts, std::span<const std::string> dataset_lines) {
  if (options.json) return print_text(facts.json());
  for (const std::string& line : facts.lines()) print_line("%s", line.c_str());
  for (const std::string& line : dataset_lines) print_line("%s", line.c_str());
}

}  // namespace

int run_info(const InfoCommand& options) {
  const std::string& path = options.files.front();
  const bool of_server = is_url_input(path);
  const std::string local = of_server ? std::string() : local_input(path);
  const ReadingTime time{Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                            std::chrono::duration<double>(std::min(options.timeout_seconds, 1e6))),
                         options.timeout_given};
  if (of_server) {
    const auto facts = describe_url(options, path, time);
    if (!facts) return kFailed;
    print_report(options, *facts, {});
    return kDone;
  }
  const std::string entry = entry_of_folder(local);
  auto mapped = net::map_file(entry.empty() ? local : entry);
  if (const auto* problem = std::get_if<net::FileError>(&mapped)) {
    const auto folder = refusal_of_folder(local);
    return fail(folder ? local + ": " + *folder : problem->message);
  }
  auto bytes = std::get<net::MappedFile>(mapped).bytes();
  JsonValue facts = JsonValue::named({{"file", path}, {"type", ""}, {"bytes", bytes.size()}});
  bytes = bytes.first(std::min(bytes.size(), options.max_bytes));
  std::vector<std::string> dataset_lines;
  if (const ContentType* type = content_type_by_mark(bytes); type && type->content == ContentClass::stream) {
    facts.put("type", type->name);
    if (!(is_outline_stream(bytes) ? describe_outlines : describe_stream)(facts, bytes, path, Budget(options.limits)))
      return kFailed;
    if (const auto changed = std::get<net::MappedFile>(mapped).changed()) return fail(local + ": " + *changed);
  } else {
    // A file of datasets is listed even if none of them can be shown.
    const ContentType& named = content_type_of(local, first_bytes(bytes));
    if (has_datasets(named) && !bytes.empty() && !is_gzip(bytes)) {
      const auto listed =
          list_datasets_confined(local, {reader_beside(local, load_options(options).allowed), {}, {}, {}, {}},
                                 std::make_shared<Budget>(options.limits));
      if (const auto* const problem = std::get_if<std::string>(&listed))
        return fail(local + ": " + std::string(named.name) + ": " + *problem);
      dataset_lines = dataset_tree(std::get<std::vector<DatasetEntry>>(listed));
      if (options.json) facts.put("datasets", dataset_list(std::get<std::vector<DatasetEntry>>(listed)));
      facts.put("type", named.name);
    }
    const auto input = open_input(options, path, MeshForm::world);
    if (!input && (dataset_lines.empty() || !options.component.dataset.empty())) return kFailed;
    if (input) describe_input(facts, *input, time);  // else the list of datasets remains
  }
  print_report(options, facts, dataset_lines);
  return kDone;
}

}  // namespace gs::app
