#include "vrml/scene/source_text.h"

#include "vrml/scene/scene_graph.h"

#include <utility>

namespace gs::vrml {

SourceText::SourceText(std::string file_name) : file_name_(std::move(file_name)) {}
SourceText::~SourceText() = default;

void SourceText::add_root(NodeId id) {
  roots_.push_back(id);
  statements_.push_back({Statement::Kind::node, id, nullptr, {}});
}

NodeType& SourceText::add_type(std::unique_ptr<NodeType> type) {
  types_.push_back(std::move(type));
  return *types_.back();
}

SceneGraph& SourceText::attach_library(std::unique_ptr<SceneGraph> library) {
  libraries_.push_back(std::move(library));
  return *libraries_.back();
}

}  // namespace gs::vrml
