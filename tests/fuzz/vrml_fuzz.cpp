// Fuzzes the readers of VRML and X3D and the execution of worlds. Any bytes must give the same scene, text, meshes and
// events, whole or in pieces.
#include "tests/fuzz/fuzz_target.h"
#include "vrml/behaviours/browser_events.h"
#include "vrml/events/execution.h"
#include "vrml/mesh/mesh.h"
#include "vrml/printing/print_scene.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"
#include "vrml/syntax/scene_reader.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

using namespace gs::vrml;

namespace gs::fuzz {
namespace {

// Checks that a pointing-device sensor sends only finite numbers.
void check_numbers(const SentEvent& event) {
  const Behaviour* behaviour = event.scene->node(event.node).type->behaviour;
  if (!behaviour || !behaviour->pointing || event.event->access != AccessType::eventOut) return;
  if (const auto* vector = std::get_if<SFVec3f>(event.value))
    require(std::isfinite(vector->x) && std::isfinite(vector->y) && std::isfinite(vector->z));
  if (const auto* turn = std::get_if<SFRotation>(event.value))
    require(std::isfinite(turn->x) && std::isfinite(turn->y) && std::isfinite(turn->z) && std::isfinite(turn->angle));
}

// Presses the button over the first object of a group, drags and releases. Then the avatar collides with the object.
void touch(Execution& execution, const SceneGraph& scene, NodeId id, double& now) {
  const Node& node = scene.node(id);
  const InterfaceDeclaration* field = node.type->find_field("children");
  if (!field || field->type != FieldType::MFNode) return;
  const auto& children = *std::get_if<MFNode>(&node.values[field->slot]);
  if (children.empty()) return;
  const Behaviour* behaviour = node.type->behaviour;
  const bool moves = behaviour && behaviour->parent_from_local;
  const PathStep path[] = {{&scene, id, glm::dmat4(1)},
                           {&scene, children[0], moves ? behaviour->parent_from_local(scene, node) : glm::dmat4(1)}};
  Pointer pointer;
  pointer.path = path;
  for (int i = 0; i < 4; ++i) {
    const double to = 0.25 * i * i;
    pointer.bearing = {{0, 0, 10}, {to, to / 2, -9}, {to, to / 2, 1}, {0, 0, 1}, {to, to}};
    pointer.down = i < 3;
    execution.pointing().point(pointer);
    execution.step(now += 0.25);
  }
  (void)collide(execution, path);
  (void)execution.pointing().pointed_at();
}

// Runs a world for some steps, and returns a digest of its events. First sends an event to each eventIn of the first
// nodes, and clicks on each of the first groups.
std::uint64_t live(SceneGraph& scene) {
  constexpr std::uint32_t kNodes = 40;
  constexpr std::size_t kEvents = 2000;
  std::uint64_t digest = 14695981039346656037u;
  std::size_t events = 0;
  Execution execution(scene);
  execution.cascade().observe([&](const SentEvent& event) {
    check_numbers(event);
    if (++events > kEvents) return;
    std::string line = event.event->name;
    print_value(line, *event.value, *event.scene);
    for (const char c : line) digest = (digest ^ static_cast<unsigned char>(c)) * 1099511628211u;
  });
  double now = 946684800;
  execution.start(now);
  for (std::uint32_t i = 1; i <= std::min<std::size_t>(kNodes, scene.nodes().count()); ++i) {
    const NodeId id = scene.nodes().id_at(i);
    if (scene.node(id).in_prototype_body) continue;
    touch(execution, scene, id, now);
    for (const InterfaceDeclaration& declaration : scene.node(id).type->interfaces)
      if (execution.send(scene, id, declaration, initial_value(declaration.type)) && i % 4 == 0)
        execution.step(now += 0.25);
  }
  execution.step(now + 1);
  return digest;
}

// Reads a text in pieces of `piece` bytes; 0 means whole.
ParseOutcome read(Grammar grammar, std::string_view text, std::size_t piece, SceneGraph& scene,
                  Diagnostics& diagnostics) {
  const auto reader = make_reader(grammar, scene, diagnostics);
  if (piece == 0) piece = text.size() + 1;
  for (std::size_t i = 0; i < text.size(); i += piece) {
    reader->push(text.substr(i, piece));
    (void)reader->open_nodes();
  }
  return reader->finish();
}

template <Grammar grammar>
bool run_world(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  Limits limits;
  limits.nodes = 20000;
  limits.expanded_nodes = 20000;
  limits.image_pixels = 1 << 16;
  SceneGraph whole("fuzz", limits), pieces("fuzz", limits);
  Diagnostics said_whole, said_pieces;
  // The worlds of the target `worlds` state their grammar.
  const Grammar used = grammar == Grammar::vrml97 ? grammar_of(text) : grammar;
  const ParseOutcome outcome =
      grammar == Grammar::vrml97 ? parse(text, whole, said_whole) : read(used, text, 0, whole, said_whole);

  // The input determines the size of the pieces, so that the fuzzer can vary it.
  const std::size_t piece = bytes.empty() ? 1 : 1 + std::to_integer<std::size_t>(bytes.back()) % 64;
  const ParseOutcome piecewise = read(used, text, piece, pieces, said_pieces);

  const std::string printed = print(whole);
  require(piecewise == outcome && print(pieces) == printed);
  require(said_whole.entries().size() == said_pieces.entries().size());
  MeshOptions coarse;
  coarse.segments = 6;
  for (std::uint32_t i = 1; i <= whole.nodes().count(); ++i) {
    const Mesh mesh = tessellate(whole, whole.nodes().id_at(i), coarse);
    for (const std::uint32_t index : mesh.indices) require(index < mesh.positions.size());
  }
  // The input determines the grammar in which the scene is written, too. The text is read again without a crash.
  constexpr Grammar kWritten[] = {Grammar::vrml97, Grammar::x3d_classic, Grammar::x3d_xml, Grammar::x3d_json};
  const std::string written = printed_scene(whole, {kWritten[bytes.size() % std::size(kWritten)]});
  SceneGraph again("again", limits);
  Diagnostics said_again;
  (void)parse(written, again, said_again);
  require(live(whole) == live(pieces));
  return said_whole.errors() == 0 && !whole.roots().empty();
}

}  // namespace

std::vector<FuzzTarget> fuzz_targets() {
  return {{"worlds", run_world<Grammar::vrml97>, 8192},
          {"inventor", run_world<Grammar::inventor>, 8192},
          {"x3d_xml", run_world<Grammar::x3d_xml>, 8192},
          {"x3d_json", run_world<Grammar::x3d_json>, 8192}};
}

}  // namespace gs::fuzz
