#include "app/script/assignments.h"

#include "app/script/bounds/field_memory.h"
#include "app/script/natives.h"

#include <js/Realm.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace gs::app::script {

bool PostedEvents::add(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId node,
                       const vrml::InterfaceDeclaration& event_in, vrml::FieldValue value) {
  const std::size_t bytes = bytes_of(value);
  if (!engine_.may_have(bytes)) {
    JS_ReportOutOfMemory(context);
    return false;
  }
  const auto count = [&](std::size_t replaced) {
    bytes_ += bytes - replaced;
    engine_.add_bytes(static_cast<std::ptrdiff_t>(bytes) - static_cast<std::ptrdiff_t>(replaced));
  };
  // Only the last value for an eventIn is sent (C.5.2). But events that add or remove children are all sent.
  const bool each = event_in.access == vrml::AccessType::eventIn && event_in.type == vrml::FieldType::MFNode;
  const Key key{{scene.serial(), node}, &event_in};
  if (!each)
    if (const auto known = last_.find(key); known != last_.end()) {
      count(bytes_of(posts_[known->second].value));
      posts_[known->second].value = std::move(value);
      return true;
    }
  if (!each) last_[key] = posts_.size();
  posts_.push_back({&scene, node, &event_in, std::move(value)});
  count(0);
  return true;
}

const vrml::FieldValue* PostedEvents::find(const vrml::SceneGraph& scene, vrml::NodeId node,
                                           const vrml::InterfaceDeclaration& event_in) const {
  const auto known = last_.find(Key{{scene.serial(), node}, &event_in});
  return known == last_.end() ? nullptr : &posts_[known->second].value;
}

// Takes time proportional to the stored events and their nodes.
void PostedEvents::apply_to_children(const vrml::SceneGraph& scene, vrml::NodeId node,
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

void PostedEvents::send_all(Program& program, bool discard) {
  std::vector<Post> posts = std::exchange(posts_, {});
  engine_.add_bytes(-static_cast<std::ptrdiff_t>(std::exchange(bytes_, 0)));
  last_.clear();
  for (const std::uint32_t place : std::exchange(program.to_send, {})) {
    program.unsent[place] = false;
    if (!discard) execution_.cascade().send_own(program.node, place);
  }
  if (discard) return;
  for (Post& post : posts)
    if (execution_.scenes().has(post.scene))
      (void)execution_.cascade().post(*post.scene, post.node, *post.event_in, std::move(post.value));
}

bool ChangedLists::add(JSContext* context, JS::HandleObject list) {
  if (lists_.get().append(list)) return true;
  JS_ReportOutOfMemory(context);
  return false;
}

bool ChangedLists::flush(JSContext* context) {
  bool good = true;
  for (std::size_t i = 0; i < lists_.get().length(); ++i) {
    JS::RootedObject list(context, lists_.get()[i]);
    const JSAutoRealm realm(context, list);  // the list may belong to another library than this turn
    good = flush_list(context, list) && good;
  }
  lists_.get().clear();
  return good;
}

}  // namespace gs::app::script
