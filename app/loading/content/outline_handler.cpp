#include "app/loading/content/outline_handler.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

// Returns true for a field that holds polygons, and for the field that marks the polygons as complete. The former are
// lists that no event can set; the latter is an SFBool.
bool is_of_polygons(const vrml::InterfaceDeclaration& field) {
  return field.slot >= 0 && (field.access == vrml::AccessType::field ? vrml::is_multiple(field.type)
                                                                     : field.type == vrml::FieldType::SFBool);
}

}  // namespace

OutlineHandler::OutlineHandler(SceneContext& context, const UrlRequest& request, const vrml::Node* begin_with)
    : ResourceHandler(context.loading, request),
      context_(context),
      own_(std::make_shared<vrml::SceneGraph>(request.file, context.loading.budget)),
      node_(own_->create(vrml::built_in_node_type(vrml::NodeKind::outline_group))),
      reader_(context.loading, *own_, node_) {
  if (!begin_with || !node_) return;
  for (const vrml::InterfaceDeclaration& field : begin_with->type->interfaces)
    if (is_of_polygons(field)) own_->node(node_).values[field.slot] = begin_with->values[field.slot];
}

OutlineHandler::~OutlineHandler() = default;

bool OutlineHandler::begin(const Found& found) { return ResourceHandler::begin(found) && node_; }

void OutlineHandler::receive(std::span<const std::byte> bytes) {
  reader_.receive(bytes);
  has_come();
}

void OutlineHandler::receive_piece(const net::CellEvent& event) {
  reader_.receive_piece(event);
  has_come();
}

void OutlineHandler::end(const std::optional<std::string>& problem) {
  if (problem) warn(": " + *problem + "; the received part is shown");
  reader_.end(found_.path, !problem && !cut);
  has_come();
}

void OutlineHandler::missing(const std::string& why) {
  ResourceHandler::missing(why);
  if (request_.place.request > 0) give();  // removes the polygons of the previous url
}

// Notes that the reader has new polygons. They are passed on only on demand, because each later growth copies the
// lists.
void OutlineHandler::has_come() {
  if (reader_.take_changed().empty()) return;
  auto& waiting = context_.outlines;
  if (std::find(waiting.begin(), waiting.end(), shared_from_this()) == waiting.end())
    waiting.push_back(shared_from_this());
}

void OutlineHandler::give() {
  if (!node_) return;
  ResourceUpdates::Outlines update{request_.place, {}, own_};
  const vrml::Node& from = own_->node(node_);
  for (const vrml::InterfaceDeclaration& field : from.type->interfaces)
    if (is_of_polygons(field)) update.fields.emplace_back(&field, from.values[field.slot]);
  loading_.results.add(std::move(update));
}

}  // namespace gs::app
