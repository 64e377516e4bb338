#include "vrml/syntax/x3d_statement_sink.h"

#include "vrml/scene/x3d/x3d_components.h"
#include "vrml/syntax/scene_sink.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace gs::vrml {
namespace {

// Limits of the statements of one text.
constexpr std::size_t kMaxImports = 65536, kMaxMetas = 4096, kMaxComponents = 256;

constexpr int kFirstVersion = 30, kLastVersion = 40;

}  // namespace

X3DStatements& X3DStatementSink::statements() { return sink_.text_.x3d(); }

X3DStatements& X3DStatementSink::shared() {
  NodeType* const type = sink_.scopes_.back().prototype;
  if (!type) return statements();
  if (!type->prototype->shared) type->prototype->shared = std::make_shared<X3DStatements>();
  return *type->prototype->shared;
}

bool X3DStatementSink::is_imported(std::string_view name) const {
  return sink_.scopes_.back().imported_names.contains(std::string(name));
}

bool X3DStatementSink::admit(std::size_t bytes) {
  constexpr std::size_t kEntry = 128;
  return sink_.scene_.memory().charge(bytes + kEntry);
}

void X3DStatementSink::set_version(int tenths, SourceLocation location) {
  const int used = std::clamp(tenths, kFirstVersion, kLastVersion);
  if (used != tenths) {
    const auto text = [](int version) { return std::to_string(version / 10) + '.' + std::to_string(version % 10); };
    sink_.problems_.warn(location, "X3D version " + text(tenths) + "; read as X3D " + text(used));
  }
  sink_.text_.set_language(Language::x3d, used);
}

void X3DStatementSink::set_profile(SourceName name) {
  if (!admit(name.text.size())) return;
  statements().profile = name.text;
  const X3DProfile* const profile = x3d_profile_named(name.text);
  if (!profile) {
    sink_.problems_.warn(name.location,
                         "unknown profile " + quoted(name.text) + "; skipped only nodes of unknown types");
  } else if (!profile->missing.empty()) {
    sink_.problems_.report(Severity::note, name.location,
                           "profile " + std::string(profile->name) +
                               " has components that are not supported: " + std::string(profile->missing));
  }
}

void X3DStatementSink::add_component(SourceName name, int level) {
  std::vector<X3DStatements::Component>& components = statements().components;
  if (components.size() >= kMaxComponents || !admit(name.text.size())) return;
  components.push_back({std::string(name.text), level});
  const X3DComponent* const component = x3d_component_named(name.text);
  if (!component) {
    sink_.problems_.warn(name.location, "unknown component " + quoted(name.text));
  } else if (component->supported == 0) {
    sink_.problems_.warn(name.location, "component " + std::string(component->name) + " is not supported");
  } else if (level > component->supported) {
    sink_.problems_.warn(name.location, "component " + std::string(component->name) + " is supported up to level " +
                                            std::to_string(component->supported) + ", not " + std::to_string(level));
  }
}

void X3DStatementSink::add_meta(std::string_view name, std::string_view content, SourceLocation location) {
  if (statements().metas.size() >= kMaxMetas) return;
  if (sink_.limits_.admits_string(name.size() + content.size(), location))
    statements().metas.push_back({std::string(name), std::string(content)});
}

void X3DStatementSink::set_unit(SourceName category, std::string_view name, double factor) {
  constexpr std::string_view kCategories[] = {"length", "angle", "mass", "force"};
  if (std::find(std::begin(kCategories), std::end(kCategories), category.text) == std::end(kCategories)) {
    sink_.problems_.warn(category.location, "unknown category of units " + quoted(category.text) +
                                                "; expected length, angle, mass or force");
    return;
  }
  if (!(factor > 0) || !std::isfinite(factor)) {
    sink_.problems_.error(category.location, "expected a conversion factor above 0; the UNIT is ignored");
    return;
  }
  if (!admit(name.size())) return;
  std::vector<X3DStatements::Unit>& units = statements().units;
  const auto same = [&](const X3DStatements::Unit& unit) { return unit.category == category.text; };
  if (std::any_of(units.begin(), units.end(), same)) {
    sink_.problems_.warn(category.location,
                         "UNIT " + quoted(category.text) + " is given twice; ignored the second one");
    return;
  }
  units.push_back({std::string(category.text), std::string(name), factor});
  if (category.text == "angle") sink_.measures_.units.angle = factor;
  if (category.text == "mass") sink_.measures_.units.mass = factor;
  if (category.text == "force") sink_.measures_.units.force = factor;
}

void X3DStatementSink::import_node(SourceName inline_name, std::string_view exported, std::string_view local) {
  if (local.empty()) local = exported;
  std::vector<X3DStatements::Import>& imports = shared().imports;
  if (imports.size() >= kMaxImports) {
    if (sink_.limits_.is_first_excess())
      sink_.problems_.error(inline_name.location,
                            "more than " + std::to_string(kMaxImports) + " IMPORTs; skipped the rest");
    return;
  }
  if (!admit(inline_name.text.size() + exported.size() + local.size())) return;
  if (!sink_.scopes_.back().imported_names.emplace(local).second) {
    sink_.problems_.error(inline_name.location, quoted(local) + " is imported twice; the first one is used");
    return;
  }
  imports.push_back(
      {{}, std::string(inline_name.text), std::string(exported), std::string(local), inline_name.location});
}

void X3DStatementSink::export_node(SourceName local, std::string_view exported) {
  if (exported.empty()) exported = local.text;
  if (sink_.scopes_.back().prototype) {
    sink_.problems_.warn_once(said_prototype_, local.location, "EXPORT in a PROTO body has no effect");
    return;
  }
  if (!admit(local.text.size() + exported.size())) return;
  statements().exports.push_back({{}, std::string(local.text), std::string(exported), local.location});
}

bool X3DStatementSink::take_route(const RouteNames& route) {
  SceneSink::Scope& scope = sink_.scopes_.back();
  if (scope.imported_names.empty()) return false;
  X3DStatements::ImportedRoute taken;
  taken.location = route.location;
  bool imported = false, skipped = false;
  const auto find = [&](const std::string& name, const std::string& event, X3DStatements::RouteEnd& end) {
    end.name = name;
    end.event = event;
    if (const NodeId* const node = scope.names.find(name)) {
      end.node = *node;
      skipped = skipped || !*node;
      return true;
    }
    const bool known = scope.imported_names.contains(name);
    imported = imported || known;
    return known;
  };
  const bool found = find(route.from, route.event_out, taken.from) & find(route.to, route.event_in, taken.to);
  if (!found || !imported) return false;
  if (shared().routes.size() >= kMaxImports) {
    if (sink_.limits_.is_first_excess())
      sink_.problems_.error(
          route.location, "more than " + std::to_string(kMaxImports) + " ROUTEs with imported nodes; skipped the rest");
    return true;
  }
  // Skipped nodes were reported already.
  if (!skipped && admit(sizeof taken)) shared().routes.push_back(std::move(taken));
  return true;
}

void X3DStatementSink::resolve_names() {
  const SourceText& text = sink_.text_;
  const SceneSink::Scope& scope = sink_.scopes_.back();
  if (scope.imported_names.empty() && (scope.prototype || text.x3d().exports.empty())) return;
  // VRML97 has no such statements.
  const Severity severity = text.language() == Language::x3d ? Severity::error : Severity::warning;
  NameTable& names = sink_.scopes_.back().names;
  std::vector<X3DStatements::Import>& imports = shared().imports;
  for (X3DStatements::Import& import : imports) {
    const NodeId* const node = names.find(import.inline_name);
    if (node && *node) import.inline_node = *node;
    if (!node)
      sink_.problems_.report(severity, import.location,
                             "IMPORT names " + quoted(import.inline_name) + ", but no DEF has this name");
    if (const NodeId* const own = names.find(import.local); own && *own)
      sink_.problems_.warn(import.location, "the imported name " + quoted(import.local) +
                                                " is also a DEF name; ROUTEs use the DEF name");
  }
  if (scope.prototype) return;  // an EXPORT there has no effect
  for (X3DStatements::Export& each : statements().exports) {
    const NodeId* const node = names.find(each.local);
    if (node && *node) each.node = *node;
    if (!node && !scope.imported_names.contains(each.local))
      sink_.problems_.report(severity, each.location,
                             "EXPORT names " + quoted(each.local) + ", but no DEF has this name");
  }
}

}  // namespace gs::vrml
