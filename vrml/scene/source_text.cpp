#include "vrml/scene/source_text.h"

#include "vrml/scene/scene_graph.h"

#include <utility>

namespace gs::vrml {

SourceText::SourceText(std::string file_name) : file_name_(std::move(file_name)) {}
SourceText::~SourceText() = default;

const X3DStatements& SourceText::x3d() const {
  static const X3DStatements none;
  return x3d_ ? *x3d_ : none;
}

X3DStatements& SourceText::x3d() {
  if (!x3d_) x3d_ = std::make_unique<X3DStatements>();
  return *x3d_;
}

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
