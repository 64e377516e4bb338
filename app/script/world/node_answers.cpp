#include "app/script/run_time_nodes.h"
#include "app/script/world/world_answers.h"
#include "vrml/syntax/printer.h"

#include <algorithm>
#include <utility>

// Questions about nodes, and their creation.
namespace gs::app::script {
namespace {

Answer describe_node(WorldAnswers& world, const Question& question) {
  Answer answer;
  const NodeAt at = world.find(question.node);
  if (!at.scene) return answer;
  const vrml::Node& node = at.get();
  answer.good = true;
  answer.flag = node.text->source() == world.running().source;
  answer.type = pointer_to(*node.type);
  return answer;
}

Answer judge_read(WorldAnswers& world, const Question& question) {
  Answer answer;
  const NodeAt at = world.find(question.node);
  answer.good = at.scene && world.may_read(at.get());
  return answer;
}

Answer read_node(WorldAnswers& world, const Question& question) {
  Answer answer;
  const NodeAt at = world.find(question.node);
  if (!at.scene || !world.may_read(at.get())) return answer;
  const vrml::NodeType& type = *at.get().type;
  if (question.place >= type.interfaces.size()) return answer;
  const vrml::FieldValue* const value =
      world.execution().cascade().last_value(*at.scene, at.node, type.interfaces[question.place]);
  answer.good = value != nullptr;
  if (value) answer.value = with_present_nodes(*at.scene, *value);
  return answer;
}

Answer name_of_node(WorldAnswers& world, const Question& question) {
  Answer answer;
  const NodeAt at = world.find(question.node);
  answer.good = at.scene && world.may_read(at.get());
  if (answer.good) answer.text = at.get().name;
  return answer;
}

Answer print_nodes(WorldAnswers& world, const Question& question) {
  Answer answer;
  const vrml::SceneGraph* const scene = world.scene_of(question.node.scene);
  const auto* const nodes = std::get_if<vrml::MFNode>(&question.value);
  if (!scene || !nodes) return answer;
  vrml::MFNode readable;
  for (const vrml::NodeId id : *nodes)
    if (!scene->contains(id) || world.may_read(scene->node(id))) readable.push_back(id);
  vrml::print_value(answer.text, vrml::FieldValue(std::move(readable)), *scene);
  answer.good = true;
  return answer;
}

Answer create_nodes(WorldAnswers& world, const Question& question) {
  constexpr std::size_t kMaxCreatedText = std::size_t{4} << 20;  // max bytes of a text of nodes
  constexpr std::size_t kWorthCollecting = 64;                   // min nodes to count for one text of nodes
  constexpr std::size_t kTextOfNode = 16;                        // min bytes of text for a node
  Answer answer;
  ScriptRecord& script = world.running();
  if (!world.may_act() || question.text.size() > kMaxCreatedText) {
    answer.text = "shutdown() cannot create nodes";
    return answer;
  }
  Diagnostics diagnostics;
  vrml::RunTimeNodes made = make_nodes(world.execution(), *script.scene, label_of(script), question.text, diagnostics,
                                       &text_of_program(script));
  for (const Diagnostic& one : diagnostics.entries()) world.messages().report(one);
  if (made.outcome == vrml::ParseOutcome::refused) {
    answer.text = "not VRML97 text";
    return answer;
  }
  answer.good = true;
  answer.node = world.ref(*script.scene, {});
  answer.place =
      static_cast<std::uint32_t>(std::max({kWorthCollecting, made.roots.size(), question.text.size() / kTextOfNode}));
  answer.value = std::move(made.roots);
  return answer;
}

Answer find_imported(WorldAnswers& world, const Question& question) {
  Answer answer;
  const vrml::ImportedNode found = world.execution().routes().imports().find(*world.running().scene, question.text);
  answer.good = found.scene != nullptr;
  if (found.scene) answer.node = world.ref(*found.scene, found.node);
  return answer;
}

// ---- ROUTEs

// Returns why the ROUTE cannot be changed; empty on success.
std::string change_route_of(WorldAnswers& world, const Question& question) {
  NodeAt from = world.find(question.node), to = world.find(question.other);
  const bool from_browser = (question.place & kFromBrowser) != 0, to_browser = (question.place & kToBrowser) != 0;
  if (!world.may_act()) return {};
  // The browser's node in the scene of the other end stands for the Browser object.
  const auto take_browser = [&](NodeAt& end, const NodeAt& other) -> std::string {
    if (!other.scene) return "expected a node at the other end of the ROUTE";
    end = {other.scene, world.execution().browser().node_in(*other.scene)};
    return end.node ? "" : "not enough memory for the ROUTE";
  };
  if (from_browser)
    if (std::string why = take_browser(from, to); !why.empty()) return why;
  if (to_browser)
    if (std::string why = take_browser(to, from); !why.empty()) return why;
  vrml::SceneGraph* const scene = from.scene;
  if (!scene || to.scene != scene || !scene->contains(from.node) || !scene->contains(to.node))
    return "expected two nodes of one file";
  const auto found = route_between(*scene, from.node, question.text, to.node, question.more);
  if (const auto* const why = std::get_if<std::string>(&found)) return *why;
  const vrml::Route& route = std::get<vrml::Route>(found);
  // Adding a ROUTE lets the target read values of the source, and may replace the program of a Script. Both need
  // permission. Every program can read the values that the browser's node receives. The values that it sends belong to
  // no file.
  const bool add = question.flag;
  const vrml::Node &source = scene->node(from.node), &target = scene->node(to.node);
  const bool same_source = !to_browser && source.text->source() == target.text->source();
  if (add && !from_browser && !same_source && !world.may_read(source)) return {};
  if (add && sets_program(*target.type, *route.event_in) && !world.may_read(target)) return {};
  // Adding a ROUTE that exists already has no effect (4.10.2).
  if (add)
    (void)world.execution().routes().add(*scene, route);
  else
    (void)world.execution().routes().remove(*scene, route);
  return {};
}

Answer change_route(WorldAnswers& world, const Question& question) {
  Answer answer;
  answer.text = change_route_of(world, question);
  answer.good = answer.text.empty();
  return answer;
}

constexpr AnswerRow kNodeRows[] = {
    {Ask::describe, describe_node},      {Ask::may_read, judge_read},       {Ask::read, read_node},
    {Ask::name, name_of_node},           {Ask::print_nodes, print_nodes},   {Ask::create_nodes, create_nodes},
    {Ask::imported_node, find_imported}, {Ask::change_route, change_route},
};

}  // namespace

std::span<const AnswerRow> answers_about_nodes() { return kNodeRows; }

}  // namespace gs::app::script
