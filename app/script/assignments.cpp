#include "app/script/assignments.h"

#include "app/script/bounds/field_memory.h"
#include "app/script/natives.h"

#include <js/Realm.h>

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

namespace gs::app::script {

bool PostedEvents::add(JSContext* context, const NodeRef& node, std::uint32_t place,
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
  const PlaceRef key{node, place};
  if (!each)
    if (const auto known = last_.find(key); known != last_.end()) {
      count(bytes_of(posts_[known->second].value));
      posts_[known->second].value = std::move(value);
      return true;
    }
  if (!each) last_[key] = posts_.size();
  posts_.push_back({node, place, std::move(value)});
  count(0);
  return true;
}

const vrml::FieldValue* PostedEvents::find(const NodeRef& node, std::uint32_t place) const {
  const auto known = last_.find(PlaceRef{node, place});
  return known == last_.end() ? nullptr : &posts_[known->second].value;
}

// Takes time proportional to the stored events and their nodes.
void PostedEvents::apply_to_children(const NodeRef& node, const vrml::NodeType& type, std::uint32_t place,
                                     vrml::FieldValue& value) const {
  const auto place_of_list = [&](const char* name) -> std::uint32_t {
    for (std::uint32_t i = 0; i < type.interfaces.size(); ++i)
      if (const vrml::InterfaceDeclaration& one = type.interfaces[i]; one.name == name)
        return one.access == vrml::AccessType::eventIn && one.type == vrml::FieldType::MFNode ? i : place;
    return place;
  };
  if (posts_.empty() || type.interfaces[place].name != "children") return;
  const std::uint32_t add = place_of_list("addChildren"), remove = place_of_list("removeChildren");
  if (add == place || remove == place) return;
  const auto changes = [&](const Post& post) {
    return post.node == node && (post.place == add || post.place == remove);
  };
  if (std::none_of(posts_.begin(), posts_.end(), changes)) return;
  std::vector<vrml::NodeId> list;
  std::unordered_map<std::uint32_t, std::size_t> places;  // positions in `list`, by node index
  const auto append = [&](vrml::NodeId child) {
    if (child && places.emplace(child.index, list.size()).second) list.push_back(child);
  };
  const std::optional<vrml::FieldValue> before = view_.read(node, place);
  if (const auto* const nodes = before ? std::get_if<vrml::MFNode>(&*before) : nullptr)
    for (const vrml::NodeId child : *nodes) append(child);
  for (const Post& post : posts_) {
    if (post.node != node) continue;
    if (post.place == place) {
      list.clear();
      places.clear();
    }
    for (const vrml::NodeId child :
         changes(post) || post.place == place ? std::get<vrml::MFNode>(post.value) : vrml::MFNode{}) {
      if (post.place != remove) {
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

void PostedEvents::send_all(Program& program) {
  std::vector<Post> posts = std::exchange(posts_, {});
  engine_.add_bytes(-static_cast<std::ptrdiff_t>(std::exchange(bytes_, 0)));
  last_.clear();
  for (const std::uint32_t place : std::exchange(program.to_tell, {})) {
    program.changed[place] = false;
    Notice notice{Notice::Kind::own_value};
    notice.place = place;
    notice.value = program.values[place];
    view_.tell(notice);
  }
  for (const std::uint32_t place : std::exchange(program.to_send, {})) {
    program.unsent[place] = false;
    Notice notice{Notice::Kind::send_own};
    notice.place = place;
    view_.tell(notice);
  }
  for (Post& post : posts) {
    Notice notice{Notice::Kind::post, post.node, post.place};
    notice.value = std::move(post.value);
    view_.tell(notice);
  }
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
