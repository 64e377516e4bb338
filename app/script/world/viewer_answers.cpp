#include "app/base/text_source.h"
#include "app/script/run_time_nodes.h"
#include "app/script/world/world_answers.h"
#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

// Questions about the viewer, its navigation and its keys.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxModeText = 256;

std::array<double, 4> orientation_of(const glm::dmat4& viewer) {
  const glm::dquat q = glm::normalize(glm::quat_cast(glm::dmat3(viewer)));
  const glm::dvec3 v(q.x, q.y, q.z);
  const double size = glm::length(v);
  return {size > 0 ? v.x / size : 0, size > 0 ? v.y / size : 0, size > 0 ? v.z / size : 1, 2 * std::atan2(size, q.w)};
}

Answer browser_facts(WorldAnswers& world, const Question&) {
  vrml::WorldBrowser& browser = world.execution().browser();
  auto facts = std::make_shared<BrowserFacts>();
  const BrowserState& state = world.browser();
  facts->speed = state.speed;
  facts->frame_rate = state.frame_rate;
  facts->start_time = browser.start_time();
  const glm::dmat4 pose = browser.pose();
  facts->position = {pose[3].x, pose[3].y, pose[3].z};
  facts->orientation = orientation_of(pose);
  facts->width = browser.view().size.x;
  facts->height = browser.view().size.y;
  const vrml::BrowserSettings& settings = browser.settings();
  const bool all[] = {settings.collision, settings.gravity, settings.sound, settings.viewpoint_animation};
  std::copy(std::begin(all), std::end(all), facts->settings);
  facts->event_mask = browser.event_mask();
  facts->world_url = state.world_url;
  facts->base_url = world.running().source ? origin_of(world.running().source).url : state.world_url;
  facts->mode = browser.mode();
  Answer answer;
  answer.good = true;
  answer.browser = std::move(facts);
  return answer;
}

Answer is_key_pressed(WorldAnswers& world, const Question& question) {
  Answer answer;
  answer.good = world.execution().browser().is_pressed(static_cast<std::int32_t>(question.place));
  return answer;
}

Answer set_event_mask(WorldAnswers& world, const Question& question) {
  world.execution().browser().set_event_mask(static_cast<std::int32_t>(question.place));
  return {};
}

Answer choose_mode(WorldAnswers& world, const Question& question) {
  world.execution().browser().choose_mode(question.text.substr(0, kMaxModeText));
  return {};
}

Answer move_viewer(WorldAnswers& world, const Question& question) {
  std::optional<glm::dvec3> position;
  std::optional<glm::dquat> orientation;
  if (const auto* const to = std::get_if<vrml::SFVec3f>(&question.value)) position = glm::dvec3(*to);
  if (const auto* const to = std::get_if<vrml::SFRotation>(&question.second))
    orientation = glm::quat_cast(vrml::rotation_matrix(*to));
  world.execution().browser().move_viewer(position, orientation);
  return {};
}

Answer bound_viewpoint(WorldAnswers& world, const Question&) {
  Answer answer;
  vrml::Execution& execution = world.execution();
  const vrml::NodeChange bound = execution.stacks().bound(vrml::built_in_node_type(vrml::NodeKind::viewpoint));
  vrml::SceneGraph* const scene = bound.scene ? execution.scenes().own(*bound.scene) : nullptr;
  answer.good = scene != nullptr;
  if (scene) answer.node = world.ref(*scene, bound.node);
  return answer;
}

Answer cast_ray(WorldAnswers& world, const Question& question) {
  Answer answer;
  const auto* const from = std::get_if<vrml::SFVec3f>(&question.value);
  const auto* const to = std::get_if<vrml::SFVec3f>(&question.second);
  const NodeAt below = world.find(question.node);
  if (!from || !to || (question.node && !below.scene)) return answer;
  const std::optional<vrml::RayHit> found =
      world.execution().browser().cast_ray(glm::dvec3(*from), glm::dvec3(*to), {below.scene, below.node});
  if (!found) return answer;
  for (const double number :
       {found->point.x, found->point.y, found->point.z, found->normal.x, found->normal.y, found->normal.z,
        static_cast<double>(found->texture_coordinate.x), static_cast<double>(found->texture_coordinate.y)})
    answer.items.emplace_back(number);
  for (const auto& [scene, node] : found->path) {
    vrml::SceneGraph* const own = world.execution().scenes().own(*scene);
    if (!own || !own->contains(node) || !world.may_read(own->node(node))) return {};
    answer.items.emplace_back(world.ref(*own, node));
  }
  answer.good = true;
  return answer;
}

// ---- NavigationInfo (6.29)

const vrml::NodeType& navigation_type() { return vrml::built_in_node_type(vrml::NodeKind::navigation_info); }

/// Returns the NavigationInfo on which the methods act; its scene is null if there is none.
NodeAt navigation_node(vrml::Execution& execution) {
  const vrml::NodeChange bound = execution.stacks().bound(navigation_type());
  if (bound.scene) return {execution.scenes().own(*bound.scene), bound.node};
  const vrml::NodePlace& made = execution.browser().made_navigation();
  const bool lives = made.scene && execution.scenes().has(made.scene) && made.scene->contains(made.node);
  return lives ? NodeAt{execution.scenes().own(*made.scene), made.node} : NodeAt{};
}

Answer navigation_value(WorldAnswers& world, const Question& question) {
  Answer answer;
  const vrml::InterfaceDeclaration* const usual = navigation_type().find_field(question.text);
  if (!usual) return answer;
  answer.good = true;
  answer.value = usual->initial;
  const NodeAt at = navigation_node(world.execution());
  if (!at.scene || !world.may_read(at.get())) return answer;
  const vrml::Node& node = at.get();
  for (std::uint32_t place = 0; place < node.type->interfaces.size(); ++place)
    if (const vrml::InterfaceDeclaration& one = node.type->interfaces[place];
        one.name == question.text && one.slot >= 0) {
      answer.node = world.ref(*at.scene, at.node);
      answer.place = place;
      answer.value = node.values[one.slot];
    }
  return answer;
}

// Makes a NavigationInfo like the present navigation. Returns no node if memory is insufficient.
NodeAt make_navigation_node(WorldAnswers& world) {
  vrml::Execution& execution = world.execution();
  vrml::SceneGraph& scene = *world.running().scene;
  const vrml::BrowserView& view = execution.browser().view();
  const auto plain = [](char c) { return c >= 'A' && c <= 'Z'; };
  const bool known = !view.mode.empty() && std::all_of(view.mode.begin(), view.mode.end(), plain);
  const std::string text = "NavigationInfo { type [ \"" + (known ? view.mode : std::string("WALK")) +
                           "\" \"ANY\" ] speed " + std::to_string(view.speed) + " }";
  Diagnostics diagnostics;
  const vrml::RunTimeNodes made =
      make_nodes(execution, scene, "Browser", text, diagnostics, &text_of_program(world.running()));
  if (made.roots.empty()) return {};
  const NodeAt at{&scene, made.roots.front()};
  execution.lifetime().hold(scene, at.node);
  execution.browser().set_made_navigation({at.scene, at.node});
  return at;
}

Answer make_navigation(WorldAnswers& world, const Question&) {
  Answer answer;
  if (!world.may_act()) return answer;
  NodeAt at = navigation_node(world.execution());
  if (!at.scene) at = make_navigation_node(world);
  answer.good = at.scene != nullptr;
  if (!at.scene) {
    answer.text = "not enough memory for a NavigationInfo";
    return answer;
  }
  answer.node = world.ref(*at.scene, at.node);
  answer.type = pointer_to(*at.get().type);
  answer.flag = !world.execution().stacks().bound(navigation_type()).scene;
  return answer;
}

constexpr AnswerRow kViewerRows[] = {
    {Ask::browser, browser_facts},   {Ask::is_pressed, is_key_pressed},   {Ask::set_event_mask, set_event_mask},
    {Ask::choose_mode, choose_mode}, {Ask::move_viewer, move_viewer},     {Ask::bound_viewpoint, bound_viewpoint},
    {Ask::cast_ray, cast_ray},       {Ask::navigation, navigation_value}, {Ask::make_navigation, make_navigation},
};

}  // namespace

std::span<const AnswerRow> answers_about_viewer() { return kViewerRows; }

}  // namespace gs::app::script
