#include "app/world/outline_handler.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

// Returns true for the fields with polygons. These are lists that only the browser and the file set, and the
// exposedField that marks them as complete.
bool is_of_polygons(const vrml::InterfaceDeclaration& field) {
  return field.slot >= 0 && (field.access == vrml::AccessType::field ? vrml::is_multiple(field.type)
                                                                     : field.type == vrml::FieldType::SFBool);
}

}  // namespace

OutlineHandler::OutlineHandler(WorldLoading::State& world, ResourceUpdates::Place group, std::string file,
                               SourceLocation location, vrml::MFString urls, const vrml::Node* begin_with)
    : world_(world),
      group_(group),
      file_(std::move(file)),
      location_(location),
      urls_(std::move(urls)),
      own_(std::make_shared<vrml::SceneGraph>(file_, world.budget)),
      node_(own_->create(vrml::built_in_node_type(vrml::NodeKind::outline_group))),
      reader_(world, *own_, node_) {
  if (!begin_with || !node_) return;
  for (const vrml::InterfaceDeclaration& field : begin_with->type->interfaces)
    if (is_of_polygons(field)) own_->node(node_).values[field.slot] = begin_with->values[field.slot];
}

OutlineHandler::~OutlineHandler() = default;

bool OutlineHandler::begin(const Found& found) {
  name_ = found.path;
  return static_cast<bool>(node_);
}

void OutlineHandler::receive(std::span<const std::byte> bytes) {
  reader_.receive(bytes);
  has_come();
}

void OutlineHandler::receive_cells(const net::CellEvent& event) {
  reader_.receive_cells(event);
  has_come();
}

void OutlineHandler::end(const std::optional<std::string>& problem) {
  if (problem)
    world_.report(Severity::warning, file_, location_, "OutlineGroup: " + *problem + "; the received part is shown");
  reader_.end(name_, !problem && !cut);
  has_come();
}

void OutlineHandler::missing(const std::string& why) {
  if (!told) world_.report(Severity::warning, file_, location_, "OutlineGroup: " + why_missing(urls_, why));
  if (group_.request > 0) give();  // removes the polygons of the former url
}

// Marks new polygons. They are passed on when they are needed, because the lists are copied if they grow later.
void OutlineHandler::has_come() {
  if (reader_.take_changed().empty()) return;
  auto& waiting = world_.outlines;
  if (std::find(waiting.begin(), waiting.end(), shared_from_this()) == waiting.end())
    waiting.push_back(shared_from_this());
}

void OutlineHandler::give() {
  if (!node_) return;
  ResourceUpdates::Outlines update{group_, {}, own_};
  const vrml::Node& from = own_->node(node_);
  for (const vrml::InterfaceDeclaration& field : from.type->interfaces)
    if (is_of_polygons(field)) update.fields.emplace_back(&field, from.values[field.slot]);
  world_.outlines_arrived(std::move(update));
}

}  // namespace gs::app
