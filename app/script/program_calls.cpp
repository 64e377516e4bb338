#include "app/script/script_world.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

// Functions of World for calls from programs.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxRequests = 256, kMaxRequestText = std::size_t{32} << 20;

bool is_object(vrml::FieldType type) {
  using vrml::FieldType;
  return vrml::is_multiple(type) || type == FieldType::SFColor || type == FieldType::SFVec2f ||
         type == FieldType::SFVec3f || type == FieldType::SFRotation || type == FieldType::SFImage;
}

}  // namespace

// Returns the simulated time, which is constant during a function. After kLooks reads in one function, each read adds
// kLook, so that a loop that waits for time to pass ends.
double World::date() {
  constexpr std::uint32_t kLooks = 1000;
  constexpr double kLook = 1e-3;  // seconds
  if (clock_looks_ < std::numeric_limits<std::uint32_t>::max()) ++clock_looks_;
  return execution_.now() + (clock_looks_ > kLooks ? kLook * (clock_looks_ - kLooks) : 0);
}

double World::random() {
  random_ ^= random_ << 13;
  random_ ^= random_ >> 7;
  random_ ^= random_ << 17;
  return static_cast<double>(random_ >> 11) * 0x1.0p-53;
}

void World::print(std::string text) {
  constexpr std::size_t kMaxText = 4096;
  if (text.size() > kMaxText) text.resize(kMaxText);
  tell({{Severity::note, "", {}, std::move(text)}, true});
}

void World::warn_once(std::string text, std::optional<Diagnostic> at) {
  report(Severity::warning, *running_, std::move(text), std::move(at));
}

// Adds a request for the session. Drops it if too many requests, or too much text, are already waiting.
void World::request(ScriptRequest request) {
  std::size_t bytes = request.text.size();
  for (const auto* const texts : {&request.urls, &request.parameters})
    for (const std::string& text : *texts) bytes += text.size();
  if (ends_ || running_->ended || requests_.size() >= kMaxRequests || bytes > kMaxRequestText - request_bytes_) return;
  request_bytes_ += bytes;
  requests_.push_back(std::move(request));
}

std::string World::modern_text_of(const Program& program, std::string_view text) {
  std::vector<std::string> values, exposed;
  for (const auto& interface : execution_.nodes().schema_of(program.node).interfaces) {
    const vrml::InterfaceDeclaration& declaration = *interface.declaration;
    if (declaration.access != vrml::AccessType::eventIn && is_object(declaration.type))
      values.push_back(declaration.name);
    if (declaration.access == vrml::AccessType::exposedField) exposed.push_back(declaration.name);
  }
  return contact_text(modern_text(text, values), exposed, is_browser_method);
}

// Takes time proportional to the stored events and their nodes.
void World::add_posted_children(const vrml::SceneGraph& scene, vrml::NodeId node,
                                const vrml::InterfaceDeclaration& children, vrml::FieldValue& value) const {
  const vrml::NodeType& type = *scene.node(node).type;
  const vrml::InterfaceDeclaration *const add = type.find("addChildren"), *const remove = type.find("removeChildren");
  const auto is_list = [](const vrml::InterfaceDeclaration* event) {
    return event && event->access == vrml::AccessType::eventIn && event->type == vrml::FieldType::MFNode;
  };
  if (children.name != "children" || !is_list(add) || !is_list(remove)) return;
  const auto changes = [&](const Post& post) {
    return post.scene == &scene && post.node == node && (post.event_in == add || post.event_in == remove);
  };
  if (std::none_of(posts_.begin(), posts_.end(), changes)) return;
  std::vector<vrml::NodeId> list;
  std::unordered_map<std::uint32_t, std::size_t> places;  // positions in `list`, by node index
  const auto append = [&](vrml::NodeId child) {
    if (child && places.emplace(child.index, list.size()).second) list.push_back(child);
  };
  for (const vrml::NodeId child : std::get<vrml::MFNode>(scene.node(node).values[children.slot])) append(child);
  for (const Post& post : posts_) {
    if (post.scene != &scene || post.node != node) continue;
    if (post.event_in == &children) {
      list.clear();
      places.clear();
    }
    for (const vrml::NodeId child :
         changes(post) || post.event_in == &children ? std::get<vrml::MFNode>(post.value) : vrml::MFNode{}) {
      if (post.event_in != remove) {
        append(child);
      } else if (const auto known = places.find(child.index); known != places.end()) {
        list[known->second] = {};
        places.erase(known);
      }
    }
  }
  vrml::MFNode made;
  for (const vrml::NodeId child : list)
    if (child) made.push_back(child);
  value = std::move(made);
}

std::string World::late_message(const Program& program) const {
  const vrml::Node& node = program.scene->node(program.id);
  return Diagnostic{Severity::error, node.text->file_name(), node.location, label(program) + ": " + kLate}.text();
}

}  // namespace gs::app::script
