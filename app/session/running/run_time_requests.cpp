#include "app/session/running/run_time_requests.h"

#include "app/formats/qnv/geometry_reader.h"
#include "app/script/run_time_nodes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxRequests = 10'000;  // max requests until the caller takes them; further ones are dropped

// Takes the inline vectors of a QNV node that was made at run time, from a text or a PROTO body. Inline vectors have
// precedence over the url field. Returns false if the node has no inline vectors.
bool take_own_vectors(LoadedWorld& world, const vrml::SceneGraph& scene, vrml::NodeId id) {
  if (scene.get<vrml::MFInt32>(id, "vectors").empty()) return false;
  const vrml::Node& node = scene.node(id);
  if (world.geometries.contains(&node)) return true;
  auto made = inline_vectors(scene, id);
  std::string problem;
  if (auto* geometry = std::get_if<qnv::Geometry>(&made)) {
    if (auto held = hold_geometry(std::move(*geometry), scene.budget()))
      world.geometries[&node] = std::move(held);
    else
      problem = scene.budget()->refusal(Resource::vectors) + "; left out";
  } else {
    problem = std::get<std::string>(made);
  }
  if (!problem.empty())
    world.diagnostics.add({Severity::warning, node.text->file_name(), node.location, "QNV: " + problem});
  return true;
}

// Returns the slot of the url field of a Script node.
int url_slot(const ScriptRequest& request) {
  const vrml::InterfaceDeclaration* const url = request.scene->node(request.node).type->find_field("url");
  return url ? url->slot : 0;
}

// Returns true if a text was read from a URL at run time.
bool was_fetched(const vrml::SourceText& text) { return &text.origin() != &text && !text.is_computed(); }

// Returns true if a Script may have computed the value of a field. Either the text with the field was computed, or an
// event has set a string of the node or of a PROTO instance around it.
bool is_computed(const vrml::SceneGraph& scene, vrml::NodeId id, int slot) {
  if (scene.nodes().text_of(id, slot).is_computed()) return true;
  for (std::uint32_t index = id.index; index != 0; index = scene.nodes().at(index).instance)
    if (scene.nodes().at(index).strings_set) return true;
  return false;
}

}  // namespace

RunTimeRequests::RunTimeRequests(LoadedWorld& world, vrml::Execution& execution, WorldPrograms& programs)
    : world_(world), execution_(execution), programs_(programs) {
  if (world.network_allowed) gate_.allow();
}

// Requests the texts that Scripts need. Requests of texts have numbers from kAsked on; smaller numbers are indices of
// url fields.
void RunTimeRequests::request_texts() {
  ScriptRunner* const runner = programs_.runner();
  if (!runner) return;
  for (ScriptRequest& one : runner->take_requests()) {
    if (one.kind == ScriptRequest::Kind::create_from_url) {
      request_text(std::move(one), true);
    } else if (one.kind == ScriptRequest::Kind::program) {
      const bool computed = one.scene->contains(one.node) && is_computed(*one.scene, one.node, url_slot(one));
      request_text(std::move(one), computed);
    } else {
      script_requests_.push_back(std::move(one));
    }
  }
}

void RunTimeRequests::request_text(ScriptRequest&& one, bool computed) {
  constexpr std::size_t kAsked = 1000;  // greater than all indices of url fields
  if (!one.scene->contains(one.node)) return;
  const vrml::Node& node = one.scene->node(one.node);
  const auto source_of_file = one.origin ? one.origin->source() : nullptr;
  const auto source = one.source ? one.source : source_of_file;
  const bool is_fetched = source != source_of_file;
  const std::size_t number = kAsked + next_text_++;
  UrlRequest request{{one.scene, one.node, number, ++url_numbers_[{&node, number}]},
                     &node,
                     vrml::UrlContent::none,
                     true,
                     nullptr,
                     {},
                     source,
                     is_fetched,
                     computed,
                     false,
                     node.type->name,
                     node.text->file_name(),
                     one.location};
  for (const std::string& url : one.urls) request.urls.push_back(vrml::SFString(url));
  url_requests_.push_back(std::move(request));
  asked_texts_[number] = std::move(one);
}

void RunTimeRequests::take_text(ResourceUpdates::Text&& update) {
  const auto asked = asked_texts_.extract(update.place.url);
  const bool gone = is_stale(update.place);
  if (!asked) {
    // The Script may be in an Inline with Scripts that have not been started yet.
    programs_.start();
    if (ScriptRunner* const runner = programs_.runner(); !gone && runner)
      runner->provide(*update.place.scene, update.place.node, std::move(update.text), update.url);
    return;
  }
  if (gone) return;
  url_numbers_.erase({&update.place.scene->node(update.place.node), update.place.url});
  if (asked.mapped().kind == ScriptRequest::Kind::program) {
    if (ScriptRunner* const runner = programs_.runner())
      runner->found(*update.place.scene, update.place.node, std::move(update.text), update.url);
    return;
  }
  if (!update.text) return;
  Diagnostics diagnostics;
  const ScriptRequest& request = asked.mapped();
  const vrml::RunTimeNodes made =
      programs_.create(*request.scene, update.url, *update.text, diagnostics, request.origin, std::move(update.source));
  (void)send_made(execution_, request, made.roots);
  for (const Diagnostic& one : diagnostics.entries()) programs_.tell({one, false});
}

bool RunTimeRequests::is_stale(const ResourceUpdates::Place& place) const {
  if (!execution_.scenes().has(place.scene) || !place.scene->contains(place.node)) return true;
  const auto number = url_numbers_.find({&place.scene->node(place.node), place.url});
  return place.request != (number == url_numbers_.end() ? 0 : number->second);
}

void RunTimeRequests::note_changes(std::span<const vrml::NodeChange> changes) {
  for (const vrml::NodeChange& change : changes) {
    const vrml::Node& node = change.scene->node(change.node);
    if (node.type->kind == vrml::NodeType::Kind::external_prototype) request_prototype(*change.scene, change.node);
    if (node.type->url_content == vrml::UrlContent::none) continue;
    const auto has_changed = [&](int slot) { return (change.slots >> std::min(slot, 63) & 1) != 0; };
    // A change of `load` loads all urls, or removes their content.
    const vrml::InterfaceDeclaration* const load = vrml::load_field(*node.type);
    const bool reload = load && has_changed(load->slot);
    const auto fields = node.type->url_fields();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (!reload && !has_changed(fields[i]->slot)) continue;
      if (node.type->url_content == vrml::UrlContent::vectors && take_own_vectors(world_, *change.scene, change.node))
        continue;
      request_url(change, i, false);
    }
  }
}

void RunTimeRequests::refresh(std::span<const vrml::NodeChange> nodes) {
  for (const vrml::NodeChange& one : nodes)
    for (std::size_t i = 0, count = one.scene->node(one.node).type->url_fields().size(); i < count; ++i)
      request_url(one, i, true);
}

// Requests the content of a url field, or of no URL if `load` is FALSE. `field` is an index of NodeType::url_fields().
void RunTimeRequests::request_url(const vrml::NodeChange& change, std::size_t field, bool refresh) {
  if (url_requests_.size() >= kMaxRequests) return;
  const vrml::Node& node = change.scene->node(change.node);
  const int slot = node.type->url_fields()[field]->slot;
  const bool loads = vrml::may_load(node);
  if (loads) execution_.loads().note(node, vrml::UrlLoad::pending);
  const vrml::SourceText& text = change.scene->nodes().text_of(change.node, slot);
  url_requests_.push_back({{change.scene, change.node, field, ++url_numbers_[{&node, field}]},
                           &node,
                           node.type->url_content,
                           false,
                           nullptr,
                           loads ? *std::get_if<vrml::MFString>(&node.values[slot]) : vrml::MFString(),
                           text.source(),
                           was_fetched(text),
                           is_computed(*change.scene, change.node, slot),
                           refresh,
                           node.type->name,
                           text.file_name(),
                           node.location});
}

// Requests the body of an EXTERNPROTO that is declared in a text that was read at run time. The loader itself fetches
// the bodies for EXTERNPROTOs in files.
void RunTimeRequests::request_prototype(vrml::SceneGraph& scene, vrml::NodeId instance) {
  const vrml::Node& node = scene.node(instance);
  if (node.type->prototype || node.type->asked_for || url_requests_.size() >= kMaxRequests) return;
  const std::optional<std::uint32_t> owner = scene.texts().declaring(node.type);
  if (!owner || *owner == 0) return;
  const vrml::WritingFor writing(scene, *owner);
  vrml::SourceText& text = scene.texts().writing();
  const auto& types = text.types();
  const auto type = std::find_if(types.begin(), types.end(), [&](const auto& one) { return one.get() == node.type; });
  (*type)->asked_for = true;
  url_requests_.push_back({{&scene, instance},
                           &node,
                           vrml::UrlContent::none,
                           false,
                           type->get(),
                           node.type->url,
                           text.source(),
                           was_fetched(text),
                           text.is_computed(),
                           false,
                           node.type->name,
                           text.file_name(),
                           node.type->location});
}

const std::string& RunTimeRequests::private_file() const {
  const ScriptRunner* const runner = programs_.runner();
  return assumed_private_.empty() && runner ? runner->private_file() : assumed_private_;
}

void RunTimeRequests::watch_private_files() {
  if (const std::string& file = private_file(); !file.empty()) gate_.close(file);
}

void RunTimeRequests::warn_held_back(const std::vector<std::string>& messages) {
  for (const std::string& text : messages)
    programs_.tell({{Severity::warning, world_.scene->file_name(), {}, "Script: " + text}, false});
}

std::vector<UrlRequest> RunTimeRequests::take_url_requests() {
  request_texts();
  watch_private_files();
  std::vector<UrlRequest> requests = gate_.take_url_requests();
  std::erase_if(requests, [&](const UrlRequest& one) { return is_stale(one.place); });
  for (UrlRequest& one : requests) {
    one.node = &one.place.scene->node(one.place.node);
    one.in_x3d = one.node->text->language() == vrml::Language::x3d;
  }
  requests.insert(requests.end(), std::make_move_iterator(url_requests_.begin()),
                  std::make_move_iterator(url_requests_.end()));
  url_requests_.clear();
  warn_held_back(gate_.hold_back(requests));
  return requests;
}

std::vector<ScriptRequest> RunTimeRequests::take_script_requests() {
  request_texts();
  watch_private_files();
  std::vector<ScriptRequest> requests = gate_.take_script_requests();
  requests.insert(requests.end(), std::make_move_iterator(script_requests_.begin()),
                  std::make_move_iterator(script_requests_.end()));
  script_requests_.clear();
  warn_held_back(gate_.hold_back(requests));
  return requests;
}

bool RunTimeRequests::open_computed_anchor(vrml::SceneGraph& scene, vrml::NodeId anchor) {
  const vrml::InterfaceDeclaration* const url = scene.node(anchor).type->find_field("url");
  if (!url || private_file().empty() || !is_computed(scene, anchor, url->slot)) return false;
  const vrml::SourceText& text = scene.nodes().text_of(anchor, url->slot);
  ScriptRequest request;
  for (const vrml::SFString& one : scene.get<vrml::MFString>(anchor, "url")) request.urls.push_back(one.str());
  for (const vrml::SFString& one : scene.get<vrml::MFString>(anchor, "parameter"))
    request.parameters.push_back(one.str());
  request.origin = &text.origin();
  request.source = text.source();
  request.scene = &scene;
  request.from_scene = &scene;
  request.node = anchor;
  request.location = scene.node(anchor).location;
  script_requests_.push_back(std::move(request));
  return true;
}

void RunTimeRequests::forget_node(const vrml::Node& node) {
  for (std::size_t i = 0, count = node.type ? node.type->url_fields().size() : 0; i < count; ++i)
    url_numbers_.erase({&node, i});
}

void RunTimeRequests::forget_scene(const vrml::SceneGraph& scene) {
  gate_.forget_scene(scene);
  std::erase_if(script_requests_, [&](const auto& one) { return one.scene == &scene || one.from_scene == &scene; });
  std::erase_if(asked_texts_,
                [&](const auto& one) { return one.second.scene == &scene || one.second.from_scene == &scene; });
  std::erase_if(url_requests_, [&](const UrlRequest& one) { return one.place.scene == &scene; });
}

}  // namespace gs::app
