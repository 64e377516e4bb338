// Fuzzes the gzip layer, and each format in the tables of content types and of volumes, with one target per row.
#include "app/base/local_file.h"
#include "app/encode/mesh_stream.h"
#include "app/formats/content_types.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/formats/volume/volume_common.h"
#include "app/script/script_runner.h"
#include "app/session/live/live_control.h"
#include "base/gzip.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/sampling/volume/gradients.h"
#include "render/scene/render_list.h"
#include "tests/app/scratch_folder.h"
#include "tests/fuzz/app_targets.h"
#include "vrml/mesh/mesh.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"
#include "vrml/syntax/scene_reader.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

using namespace gs::app;

namespace gs::fuzz {
namespace {

namespace fs = std::filesystem;

Limits small_limits() {
  Limits limits;
  limits.nodes = 20000;
  limits.expanded_nodes = 20000;
  limits.image_pixels = 1 << 16;
  return limits;
}

/// Tessellates, draws and prints an imported scene.
void check_scene(const vrml::SceneGraph& scene) {
  vrml::MeshOptions coarse;
  coarse.segments = 6;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::Mesh mesh = tessellate(scene, scene.nodes().id_at(i), coarse);
    for (const std::uint32_t index : mesh.indices) require(index < mesh.positions.size());
  }
  render::MeshCache meshes;
  (void)render::collect(scene, {}, meshes);
}

// Reads the JSON of a running simulation.
bool run_live_state(std::span<const std::byte> bytes) {
  const auto state = read_live_state(text_of(bytes));
  if (!state) return false;
  for (const LiveParameter& one : state->parameters)
    require(!one.name.empty() && one.minimum <= one.maximum && std::isfinite(one.value));
  return true;
}

bool run_vrml(const ContentType& type, std::span<const std::byte> bytes) {
  vrml::SceneGraph scene("fuzz", small_limits());
  Diagnostics diagnostics;
  const auto reader = vrml::make_reader(type.grammar, scene, diagnostics);
  if (is_gzip(bytes))
    (void)gunzip(bytes, std::make_shared<Budget>(Limits{.memory = std::size_t{1} << 16}), [&](std::string_view piece) {
      reader->push(piece);
      return true;
    });
  else
    reader->push(text_of(bytes));
  (void)reader->finish();
  check_scene(scene);
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::NodeId node = scene.nodes().id_at(i);
    if (!(scene.resolve_as(node, vrml::NodeKind::qnv) == node)) continue;
    const auto made = inline_vectors(scene, node);
    if (const auto* geometry = std::get_if<qnv::Geometry>(&made))
      require(qnv::VectorView(*geometry).normals.size() == geometry->size());
    (void)transfer_of(scene.get<vrml::MFFloat>(node, "transfer"));
  }
  return diagnostics.errors() == 0 && !scene.roots().empty();
}

bool run_mesh(const ContentType& type, std::span<const std::byte> bytes) {
  const TwoFiles files = two_files(bytes);
  const auto budget = std::make_shared<Budget>(small_limits());
  Diagnostics diagnostics;
  int reads = 0;
  // All references lead to the second file of the input.
  const ReadFile read_file = [&](const std::string&) -> BytesResult {
    if (files.other.empty() || ++reads > 8) return "there is no other";
    return shared_bytes(std::vector(files.other.begin(), files.other.end()));
  };
  const auto scene = import_scene(type, {files.first, "fuzz", read_file, budget, diagnostics});
  for (const Diagnostic& diagnostic : diagnostics.entries()) require(!diagnostic.message.empty());
  if (scene) check_scene(*scene);
  if (scene && scene->nodes().count() <= 2000) (void)vrml::print(*scene);
  // Read it again as a stream of a mesh that does not fit into memory.
  if (const auto stream = open_mesh_stream(files.first)) {
    std::uint64_t triangles = 0;
    require(stream->source([&](std::span<const qnv::Triangle> some) {
      triangles += some.size();
      return true;
    }));
    require(triangles <= files.first.size());
  }
  return diagnostics.errors() == 0 && scene;
}

void check_vectors(const qnv::VectorView& vectors) {
  require(vectors.normals.size() == vectors.size() && vectors.weights.size() == vectors.size());
  require(vectors.colors.empty() || vectors.colors.size() == vectors.size());
  require(vectors.classes.empty() || vectors.classes.size() == vectors.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const glm::vec3 &p = vectors.positions[i], &n = vectors.normals[i];
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    require(std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z));
    require(std::isfinite(vectors.weights[i]));
  }
}

/// Fuzzes a format of streams or vectors, also compressed by gzip.
bool run_geometry(const ContentType& type, std::span<const std::byte> bytes) {
  Diagnostics diagnostics;
  const LoadLimit limit(std::chrono::steady_clock::now() + std::chrono::hours(1));
  const auto geometry = read_geometry(type, {"fuzz", bytes}, diagnostics, limit);
  require(geometry || diagnostics.errors() > 0 || bytes.empty());
  if (!geometry) return false;
  if (const auto* octree = geometry->as<qnv::OctreeSplats>())
    check_vectors(octree->stream->whole());
  else
    check_vectors(*geometry);
  vrml::SceneGraph scene;
  (void)add_geometry_shape(scene, *geometry, "fuzz");
  return diagnostics.errors() == 0;
}

/// Folder with two files: one that headers may name, "volume.img", and the partner in formats of two files.
class VolumeFolder {
 public:
  [[nodiscard]] std::string header() const { return folder_.path("volume.hdr"); }
  void write(std::span<const std::byte> bytes) {
    if (bytes.empty() && !written_) return;
    folder_.write("volume.img", text_of(bytes));
    written_ = !bytes.empty();
  }

 private:
  ScratchFolder folder_;
  bool written_ = false;
};

/// Opens a volume without a header. The first byte of the input selects its type and size.
VolumeResult open_without_header(const VolumeFile& file) {
  constexpr std::size_t kChoices = 6;
  RawVolume raw;
  const std::span<const std::byte> bytes = file.content.bytes;
  if (bytes.size() < kChoices) return std::string("too short");
  for (std::size_t i = 0; i < 3; ++i) raw.dimensions[i] = std::to_integer<std::uint32_t>(bytes[i]);
  raw.type = static_cast<qnv::VoxelType>(std::to_integer<unsigned>(bytes[3]) % 8);
  raw.big_endian = std::to_integer<unsigned>(bytes[4]) % 2 == 1;
  raw.offset = std::to_integer<std::uint64_t>(bytes[5]);
  return open_raw(file, raw);
}

bool run_volume(const VolumeFormat& format, std::span<const std::byte> bytes) {
  static VolumeFolder folder;
  const TwoFiles files = two_files(bytes);
  folder.write(files.other);
  VolumeFile file;
  file.path = folder.header();
  file.read_beside = reader_beside(file.path, {});
  file.content = shared_bytes(std::vector(files.first.begin(), files.first.end()));
  if (is_gzip(files.first)) {
    const auto unpacked =
        std::make_shared<const UnpackedBytes>(unpack_gzip(files.first, file.budget, Resource::volumes));
    if (unpacked->problem) return false;
    file.content = {unpacked, unpacked->bytes.span()};
  }
  const VolumeResult opened = format.sniff ? format.open(file) : open_without_header(file);
  const auto* source = std::get_if<qnv::VolumeSource>(&opened);
  if (!source) {
    require(!std::get<std::string>(opened).empty());
    return false;
  }
  require(!qnv::check(source->layout));
  if (qnv::voxel_count(source->layout) > std::size_t{1} << 18) return false;
  std::vector<std::byte> scratch;
  std::vector<float> slice(qnv::slice_voxels(source->layout));
  // Parts of a file of datasets are decoded when they are read, so that damage shows late.
  for (std::uint32_t z = 0; z < source->layout.dimensions[2]; ++z)
    if (!read_slice(*source, z, scratch, slice)) {
      require(format.open == open_datasets);
      return false;
    }
  qnv::GradientOptions options;
  options.threads = 1;
  const auto vectors = qnv::gradient_vectors(*source, options);
  if (const auto* volume = std::get_if<qnv::Volume>(&vectors)) check_vectors(*volume);
  return true;
}

/// Decompresses the input at once and in pieces. Both must give equal bytes and equal errors.
bool run_gzip(std::span<const std::byte> bytes) {
  constexpr std::size_t kMax = std::size_t{1} << 20;
  std::string whole, pieces;
  const Limits limits{.memory = kMax};
  const auto problem = gunzip(bytes, std::make_shared<Budget>(limits), [&](std::string_view piece) {
    whole += piece;
    return true;
  });
  Gunzip unpacking(std::make_shared<Budget>(limits));
  in_pieces(bytes, [&](std::span<const std::byte> piece) {
    (void)unpacking.push(piece, [&](std::string_view out) {
      pieces += out;
      return true;
    });
  });
  const auto other = unpacking.finish();
  require(whole.size() <= kMax && whole == pieces && problem.has_value() == other.has_value());
  (void)content_type_of("fuzz", first_bytes(bytes));
  return !problem && !whole.empty();
}

// Runs any text as the program of a Script that has fields of all types. Returns true if the engine accepts the text.
bool run_program(std::span<const std::byte> bytes) {
  Limits limits = small_limits();
  limits.script_seconds = 0.1;
  limits.script_heap = std::size_t{32} << 20;
  vrml::SceneGraph scene("fuzz.wrl", limits);
  Diagnostics diagnostics;
  (void)vrml::parse(
      "#VRML V2.0 utf8\nDEF T Transform {} DEF S Script { directOutput TRUE field SFNode node USE T field SFNode me "
      "USE S "
      "field SFVec3f v 1 2 3 field MFVec3f list [] field MFString text [] field SFImage image 1 2 1 3 4 field SFInt32 "
      "count 0 "
      "eventIn SFFloat go eventOut SFVec3f out }",
      scene, diagnostics);
  const vrml::NodeId script = scene.roots()[1];  // the program may remove this node
  const vrml::InterfaceDeclaration* const go = scene.node(script).type->find_event_in("go");
  vrml::MFString& url =
      std::get<vrml::MFString>(scene.node(script).values[scene.node(script).type->find_field("url")->slot]);
  url.push_back(vrml::SFString("javascript:" + std::string(text_of(bytes))));
  Diagnostics wrong;
  check_programs(scene, wrong);
  vrml::Execution execution(scene);
  const auto runner = ScriptRunner::make(execution, {0, true});
  require(runner != nullptr);
  execution.scripts().set_host(runner.get());
  execution.start(1000);
  for (int i = 1; i <= 3; ++i) {
    runner->begin_step();
    execution.step(1000 + i);
    if (scene.contains(script)) (void)execution.send(scene, script, *go, vrml::SFFloat(2));
    (void)runner->take_messages();
    (void)runner->take_requests();
  }
  return wrong.errors() == 0;
}

}  // namespace

std::vector<FuzzTarget> fuzz_targets() {
  constexpr std::size_t kMaxBytes = 8192;
  std::vector<FuzzTarget> targets = {{"gzip", run_gzip},
                                     {"programs", run_program},
                                     {"control_messages", run_control_messages},
                                     {"program_messages", run_program_messages},
                                     {"live_state", run_live_state},
                                     {"asset_transfer", run_asset_transfer, kMaxBytes},
                                     {"volume_transfer", run_volume_transfer, kMaxBytes}};
  constexpr std::size_t kMaxWorld = 65536;
  targets.push_back({"script_worlds", run_script_world, kMaxWorld});
  using Bytes = std::span<const std::byte>;
  for (const ContentType& type : content_types()) {
    const std::string name = target_name(type.name);
    switch (type.content) {
      case ContentClass::vrml:
        targets.push_back({name, [&type](Bytes bytes) { return run_vrml(type, bytes); }, kMaxBytes});
        break;
      case ContentClass::mesh:
        targets.push_back({name, [&type](Bytes bytes) { return run_mesh(type, bytes); }, kMaxBytes});
        break;
      case ContentClass::stream:
      case ContentClass::splats:
        targets.push_back({name, [&type](Bytes bytes) { return run_geometry(type, bytes); }, kMaxBytes});
        break;
      case ContentClass::volume:
        break;  // volumes have their own table
    }
  }
  for (const VolumeFormat& format : volume_formats())
    targets.push_back(
        {target_name(format.name.name), [&format](Bytes bytes) { return run_volume(format, bytes); }, kMaxBytes});
  return targets;
}

}  // namespace gs::fuzz
