#include "app/base/text_source.h"
#include "app/script/run_time_nodes.h"
#include "app/script/world/world_answers.h"

#include <utility>

// Requests of programs to the session (VRML97 4.12.10), and properties of the browser.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxRequestedText = 4096;  // max characters of a description

ScriptRequest request_of(WorldAnswers& world, ScriptRequest::Kind kind) {
  ScriptRequest request;
  request.kind = kind;
  const ScriptRecord& script = world.running();
  request.origin = &text_of_program(script).origin();
  request.source = script.source;
  request.scene = script.scene;
  request.from_scene = script.scene;
  request.node = script.id;
  request.location = script.scene->node(script.id).location;
  return request;
}

// Adds a request, unless the program or the world ends.
Answer add_request(WorldAnswers& world, ScriptRequest request) {
  if (world.may_act()) world.requests().add(std::move(request));
  Answer answer;
  answer.good = true;
  return answer;
}

std::vector<std::string> texts_of(const vrml::FieldValue& value) {
  std::vector<std::string> texts;
  if (const auto* const list = std::get_if<vrml::MFString>(&value))
    for (const vrml::SFString& text : *list) texts.push_back(text.str());
  return texts;
}

Answer create_from_url(WorldAnswers& world, const Question& question) {
  const NodeAt at = world.find(question.node);
  const vrml::InterfaceDeclaration* const event_in =
      at.scene ? event_for_nodes(*at.scene, at.node, question.text) : nullptr;
  if (!event_in) return {};
  ScriptRequest request = request_of(world, ScriptRequest::Kind::create_from_url);
  request.urls = texts_of(question.value);
  request.scene = at.scene;
  request.node = at.node;
  request.event_in = event_in;
  return add_request(world, std::move(request));
}

Answer load_url(WorldAnswers& world, const Question& question) {
  ScriptRequest request = request_of(world, ScriptRequest::Kind::load_url);
  request.urls = texts_of(question.value);
  request.parameters = texts_of(question.second);
  return add_request(world, std::move(request));
}

template <ScriptRequest::Kind kKind>
Answer request_text(WorldAnswers& world, const Question& question) {
  ScriptRequest request = request_of(world, kKind);
  constexpr std::size_t kBytesOfCharacter = 4;
  request.text = question.text.substr(0, kMaxRequestedText * kBytesOfCharacter);
  return add_request(world, std::move(request));
}

Answer replace_world(WorldAnswers& world, const Question& question) {
  Answer answer;
  const auto* const nodes = std::get_if<vrml::MFNode>(&question.value);
  // Nodes of the program's scene are nodes of the root, or the world has none of them.
  answer.good = !world.may_act() || (nodes && world.execution().lifetime().replace_world(*nodes));
  return answer;
}

Answer give_setting(WorldAnswers& world, const Question& question) {
  vrml::BrowserSettings& settings = world.execution().browser().settings();
  bool* const all[] = {&settings.collision, &settings.gravity, &settings.sound, &settings.viewpoint_animation};
  Answer answer;
  answer.good = question.place < std::size(all);
  if (answer.good) *all[question.place] = question.flag;
  return answer;
}

constexpr AnswerRow kBrowserRows[] = {
    {Ask::create_from_url, create_from_url},
    {Ask::load_url, load_url},
    {Ask::describe_world, request_text<ScriptRequest::Kind::description>},
    {Ask::set_viewpoint, request_text<ScriptRequest::Kind::viewpoint>},
    {Ask::replace_world, replace_world},
    {Ask::set_setting, give_setting},
};

}  // namespace

std::span<const AnswerRow> answers_of_browser() { return kBrowserRows; }

}  // namespace gs::app::script
