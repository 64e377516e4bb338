#include "app/script/x3d/x3d_natives.h"

// The objects of ISO/IEC 19777-1 that need no access to the engine, in ECMAScript. The functions $x3d_... are in
// x3d_natives.cpp. Programs do not see the names that this text declares, except those that is_library_name() lists.
namespace gs::app::script {

std::string_view x3d_library_text() {
  return R"js("use strict";
(function (library) {
const fieldTypes = ["SFBool", "SFColor", "SFColorRGBA", "SFDouble", "SFFloat", "SFImage", "SFInt32", "SFMatrix3d",
  "SFMatrix3f", "SFMatrix4d", "SFMatrix4f", "SFNode", "SFRotation", "SFString", "SFTime", "SFVec2d", "SFVec2f",
  "SFVec3d", "SFVec3f", "SFVec4d", "SFVec4f"];
// In the order of the access types of VRML97: eventIn, eventOut, field, exposedField.
const accessNames = ["inputOnly", "outputOnly", "initializeOnly", "inputOutput"];
const accessValues = {initializeOnly: 1, inputOnly: 2, outputOnly: 4, inputOutput: 7};

// ---- X3DConstants

const constants = {
  INITIALIZED_EVENT: 0, SHUTDOWN_EVENT: 1, CONNECTION_ERROR: 2, INITIALIZED_ERROR: 3,
  NOT_STARTED_STATE: 0, IN_PROGRESS_STATE: 1, COMPLETE_STATE: 2, FAILED_STATE: 3
};
Object.assign(constants, accessValues);
for (const multiple of [false, true])
  fieldTypes.forEach((name, i) =>
    constants[multiple ? "M" + name.substr(1) : name] = i + (multiple ? fieldTypes.length : 0));
for (const name of $x3d_typeNames().split(" "))
  if (name && !(name in constants)) constants[name] = Object.keys(constants).length + 100;
define("X3DConstants", Object.freeze(constants));

// ---- Arrays and descriptions, which programs may read only

function define(name, value) {
  Object.defineProperty(library, name, {value: value});
}
function arrayClass(name) {
  const made = {[name]: class extends Array {
    toString() { return "[object " + name + "]"; }
  }}[name];
  Object.defineProperty(made, Symbol.species, {value: Array});
  define(name, made);
  return list => Object.freeze(made.from(list));
}
const routeArray = arrayClass("RouteArray"), fieldArray = arrayClass("FieldDefinitionArray");
const protoArray = arrayClass("ProtoDeclarationArray"), externProtoArray = arrayClass("ExternProtoDeclarationArray");
const profileArray = arrayClass("ProfileInfoArray"), componentArray = arrayClass("ComponentInfoArray");

function info(name, properties) {
  const made = {[name]: class {
    constructor(values) {
      Object.assign(this, values);
      Object.freeze(this);
    }
    toString() { return "[object " + name + "]"; }
  }}[name];
  Object.assign(made.prototype, properties);
  Object.freeze(made.prototype);
  define(name, made);
  return made;
}
const X3DRoute = info("X3DRoute"), X3DFieldDefinition = info("X3DFieldDefinition");
const ProfileInfo = info("ProfileInfo"), ComponentInfo = info("ComponentInfo");
const X3DProtoDeclaration = info("X3DProtoDeclaration", {
  newInstance() { return $x3d_createProto(this.$of, this.name); }
});
const X3DExternProtoDeclaration = info("X3DExternProtoDeclaration", {
  newInstance() { return $x3d_createProto(this.$of, this.name); },
  loadNow() {}
});

function definitions(list, valueOf) {
  const fields = [];
  for (let i = 0; i < list.length; i += 3) {
    const type = list[i + 2], access = accessNames[list[i + 1]];
    fields.push(new X3DFieldDefinition({name: list[i], accessType: accessValues[access], dataType: type,
      accessName: access,
      typeName: type < fieldTypes.length ? fieldTypes[type] : "M" + fieldTypes[type - fieldTypes.length].substr(1),
      value: valueOf && access != "inputOnly" ? valueOf(list[i]) : undefined}));
  }
  return fieldArray(fields);
}

const componentLevels = {};
const known = $x3d_components();
for (let i = 0; i < known.length; i += 2) componentLevels[known[i]] = known[i + 1];
function component(name, level) {
  if (!(name in componentLevels)) throw new Error("component '" + name + "' is not supported");
  if (level > componentLevels[name]) throw new Error("component " + name + " has level " + componentLevels[name]);
  return new ComponentInfo({name: name, title: name, level: level || componentLevels[name], providerUrl: ""});
}
const profileNames = ["Core", "Interchange", "CADInterchange", "Interactive", "MPEG-4", "MedicalInterchange",
  "Immersive", "Full"];
function profile(name) {
  if (profileNames.indexOf(name) < 0) throw new Error("profile '" + name + "' is not supported");
  return new ProfileInfo({name: name, title: name, providerUrl: "",
    components: componentArray(Object.keys(componentLevels).map(one => component(one)))});
}

)js"
         R"js(// ---- X3DExecutionContext and X3DScene

const contexts = new Map();  // the contexts of texts of files, by their key
const hidden = new WeakMap();  // data of contexts

class X3DExecutionContext {
  get specificationVersion() { return (hidden.get(this).facts[2] / 10).toFixed(1); }
  get encoding() { return hidden.get(this).list ? "SCRIPTED" : "VRML"; }
  get worldURL() { return hidden.get(this).facts[1]; }
  get profile() {
    const wanted = hidden.get(this).facts[4];
    return profile(wanted && profileNames.indexOf(wanted) >= 0 ? wanted : "Full");
  }
  get components() {
    const list = $x3d_statedComponents(nodeOf(this)), found = [];
    for (let i = 0; i < list.length; i += 2)
      if (list[i] in componentLevels) found.push(component(list[i], Math.min(list[i + 1], componentLevels[list[i]])));
    return componentArray(found);
  }
  get rootNodes() { return rootsOf(this); }
  set rootNodes(nodes) { setRoots(this, nodes); }
  get routes() {
    const list = $x3d_routes(nodeOf(this)), routes = [];
    for (let i = 0; i < list.length; i += 4) routes.push(route(list[i], list[i + 1], list[i + 2], list[i + 3]));
    return routeArray(routes);
  }
  get protos() {
    const of = nodeOf(this);
    return protoArray($x3d_protos(of, false).map(name => new X3DProtoDeclaration({name: name, $of: of,
      isExternProto: false, fields: definitions($x3d_protoFields(of, name))})));
  }
  get externprotos() {
    const of = nodeOf(this);
    return externProtoArray($x3d_protos(of, true).map(name => new X3DExternProtoDeclaration({name: name, $of: of,
      isExternProto: true, fields: definitions($x3d_protoFields(of, name)), urls: $x3d_protoUrls(of, name),
      loadState: constants.COMPLETE_STATE})));
  }
  getRootNodes() { return this.rootNodes; }
  getVersion() { return this.specificationVersion; }
  getWorldURL() { return this.worldURL; }
  createNode(type) {
    if (!/^[A-Za-z_][\w-]*$/.test(type) || !(type in constants)) throw new Error("unknown node type '" + type + "'");
    const made = plain.createVrmlFromString(type + " { }")[0];
    if (!made) throw new Error("cannot create a node of type '" + type + "'");
    return made;
  }
  createProto(name) {
    const made = $x3d_createProto(nodeOf(this), String(name));
    if (!made) throw new Error("unknown PROTO '" + name + "'");
    return made;
  }
  getNamedNode(name) {
    const own = hidden.get(this).names;
    const found = own.has(String(name)) ? own.get(String(name)) : $x3d_named(nodeOf(this), String(name));
    if (!found) throw new Error("no node is called '" + name + "'");
    return found;
  }
  updateNamedNode(name, node) { hidden.get(this).names.set(String(name), node); }
  addNamedNode(name, node) { this.updateNamedNode(name, node); }
  removeNamedNode(name) { hidden.get(this).names.set(String(name), null); }
  getImportedNode(name) {
    const own = hidden.get(this).imports;
    const found = own.has(String(name)) ? own.get(String(name))
      : Browser.getImportedNode ? Browser.getImportedNode(String(name)) : null;
    if (!found) throw new Error("no imported node is called '" + name + "'");
    return found;
  }
  updateImportedNode(name, local) {
    hidden.get(this).imports.set(String(local), typeof name == "object" ? name : this.getImportedNode(name));
  }
  removeImportedNode(name) { hidden.get(this).imports.set(String(name), null); }
  addRoute(from, out, to, into) {
    Browser.addRoute(from, String(out), to, String(into));
    return route(from, String(out), to, String(into));
  }
  deleteRoute(from, out, to, into) {
    if (from instanceof X3DRoute)
      Browser.deleteRoute(from.sourceNode, from.sourceField, from.destinationNode, from.destinationField);
    else
      Browser.deleteRoute(from, String(out), to, String(into));
  }
  toXMLString() {
    const nodes = Array.from(this.rootNodes).map(node => node ? node.toXMLString() : "");
    return "<X3D profile='" + this.profile.name + "' version='" + this.specificationVersion + "'><Scene>" +
      nodes.join("") + "</Scene></X3D>";
  }
  toVRMLString() { return Array.from(this.rootNodes).map(node => node ? node.toVRMLString() : "").join("\n"); }
  addRootNode(node) {
    const nodes = Array.from(rootsOf(this));
    if (nodes.indexOf(node) < 0) setRoots(this, nodes.concat([node]));
  }
  removeRootNode(node) { setRoots(this, Array.from(rootsOf(this)).filter(one => one !== node)); }
  toString() { return "[object " + (this instanceof X3DScene ? "X3DScene" : "X3DExecutionContext") + "]"; }
}

class X3DScene extends X3DExecutionContext {
  setMetaData(name, value) { hidden.get(this).metas.set(String(name), String(value)); }
  getMetaData(name) {
    const data = hidden.get(this);
    const list = data.metas.has(String(name)) ? [] : $x3d_metas(nodeOf(this));
    for (let i = 0; i < list.length; i += 2) if (list[i] == name) return list[i + 1];
    if (!data.metas.has(String(name))) throw new Error("no metadata is called '" + name + "'");
    return data.metas.get(String(name));
  }
  getExportedNode(name) {
    const own = hidden.get(this).exported;
    const found = own.has(String(name)) ? own.get(String(name)) : $x3d_exported(nodeOf(this), String(name));
    if (!found) throw new Error("no exported node is called '" + name + "'");
    return found;
  }
  updateExportedNode(name, node) { hidden.get(this).exported.set(String(name), node); }
  removeExportedNode(name) { hidden.get(this).exported.set(String(name), null); }
}
define("X3DExecutionContext", X3DExecutionContext);
define("X3DScene", X3DScene);

function route(from, out, to, into) {
  return new X3DRoute({sourceNode: from, sourceField: out, destinationNode: to, destinationField: into});
}
// Returns a context with a list of nodes, or with the children of the Group `holder`, or of the text that has these
// `facts` of $x3d_context().
function context(Class, facts, list, holder) {
  const made = new Class();
  hidden.set(made, {facts: facts, list: list, holder: holder, names: new Map(), imports: new Map(), exported: new Map(),
    metas: new Map()});
  return Object.freeze(made);
}
function nodeOf(context) {
  const data = hidden.get(context), list = data.holder ? data.holder.children : data.list;
  return list && list.length > 0 ? list[0] : null;
}
function rootsOf(context) {
  const data = hidden.get(context);
  return data.holder ? data.holder.children : data.list || $x3d_roots(null);
}
function setRoots(context, nodes) {
  const data = hidden.get(context);
  if (data.holder) {
    data.holder.children = new MFNode(...nodes);
  } else if (data.list) {
    data.list.length = 0;
    for (let i = 0; i < nodes.length; ++i) data.list[i] = nodes[i];
  } else if (!$x3d_setRoots(nodes)) {
    throw new Error("only the top-level nodes of a file can be replaced");
  }
}
function currentContext() {
  const facts = $x3d_context(null);
  let found = contexts.get(facts[0]);
  if (!found) contexts.set(facts[0], found = context(facts[3] ? X3DExecutionContext : X3DScene, facts, null));
  return found;
}
function sceneOf(nodes) {
  const list = new MFNode();
  for (let i = 0; i < nodes.length; ++i) list[i] = nodes[i];
  return context(X3DScene, $x3d_context(list.length > 0 ? list[0] : null), list);
}

)js"
         R"js(// ---- Browser

const Browser = library.Browser;
const plain = {};
for (const name of ["replaceWorld", "createVrmlFromString", "createVrmlFromURL"]) plain[name] = Browser[name];
const rendering = {Shading: "PHONG", MaxTextureSize: "16384x16384", TextureUnits: 8, AntiAliased: true,
  Antialiased: true, ColorDepth: 24, TextureMemory: 0};
let description = "";
const methods = {
  replaceWorld(scene) { plain.replaceWorld(scene instanceof X3DExecutionContext ? scene.rootNodes : scene); },
  createX3DFromString(text) { return sceneOf(plain.createVrmlFromString(text)); },
  createScene() { return sceneOf([]); },
  createX3DFromURL(url, node, field) {
    if (node) return plain.createVrmlFromURL(url, node, String(field));
    // A program cannot wait for a file: the scene stays empty until the file is loaded into this Group.
    const holder = plain.createVrmlFromString("Group { }")[0];
    plain.createVrmlFromURL(url, holder, "addChildren");
    return context(X3DScene, $x3d_context(holder), null, holder);
  },
  createX3DFromStream() { throw new Error("createX3DFromStream is not supported"); },
  importDocument(document) {
    const top = document && (document.documentElement || document);
    const text = typeof document == "string" ? document : top && top.outerHTML;
    if (!text) throw new Error("importDocument expects a document, or the text of one");
    return sceneOf(plain.createVrmlFromString(String(text)));
  },
  importJS(json) { return sceneOf(plain.createVrmlFromString(typeof json == "string" ? json : JSON.stringify(json))); },
  getRenderingProperty(name) {
    if (!(name in rendering)) throw new Error("unknown rendering property '" + name + "'");
    return rendering[name];
  },
  getRenderingProperties() { return Object.assign({}, rendering); },
  getBrowserProperty() { return false; },
  getBrowserProperties() { return {}; },
  getProfile(name) { return profile(String(name)); },
  getComponent(name, level) { return component(String(name), level); },
  addBrowserListener() {},
  removeBrowserListener() {},
  getCurrentScene() { return currentContext(); },
  getSupportedProfiles() { return Browser.supportedProfiles; },
  getSupportedComponents() { return Browser.supportedComponents; }
};
for (const name in methods)
  Object.defineProperty(Browser, name, {value: methods[name], writable: true, configurable: true});
Object.defineProperties(Browser, {
  description: {get() { return description; }, set(text) {
    description = String(text);
    Browser.setDescription(description);
  }, enumerable: true},
  currentScene: {get: currentContext, enumerable: true},
  supportedComponents: {get() {
    return componentArray(Object.keys(componentLevels).map(name => component(name)));
  }, enumerable: true},
  supportedProfiles: {get() { return profileArray(profileNames.map(profile)); }, enumerable: true}
});

// ---- Fields

function add(prototype, members) {
  for (const name in members)
    Object.defineProperty(prototype, name, {value: members[name], writable: true, configurable: true});
}
function valueText(type, value) {
  const one = part => typeof part == "string" ? JSON.stringify(part)
    : typeof part == "boolean" ? String(part).toUpperCase() : part === null || part === undefined ? "NULL" : part.toVRMLString ? part.toVRMLString() : String(part);
  if (type[0] == "S") return one(value);
  const texts = [];
  for (let i = 0; i < value.length; ++i) texts.push(one(value[i]));
  return "[ " + texts.join(", ") + " ]";
}
function attribute(type, value) {
  let text = type == "MFString" ? Array.from(value).map(one => JSON.stringify(one)).join(" ")
    : type == "MFBool" ? Array.from(value).join(" ") : String(value).replace(/^\[ ?| ?\]$/g, "");
  for (const [from, to] of [["&", "&amp;"], ["<", "&lt;"], ["'", "&apos;"]]) text = text.split(from).join(to);
  return text;
}
function element(node, container) {
  const name = node.getNodeName(), children = [];
  let text = "<" + node.getNodeTypeName() + (name ? " DEF='" + name + "'" : "");
  for (const field of node.getFieldDefinitions()) {
    if (field.accessType != constants.inputOutput && field.accessType != constants.initializeOnly) continue;
    if (field.dataType == constants.SFNode || field.dataType == constants.MFNode) {
      const nodes = field.dataType == constants.SFNode ? [field.value] : Array.from(field.value);
      for (const one of nodes) if (one) children.push(element(one, field.name));
    } else if (field.value !== undefined) {
      text += " " + field.name + "='" + attribute(field.typeName, field.value) + "'";
    }
  }
  if (container) text += " containerField='" + container + "'";
  return text + (children.length > 0 ? ">" + children.join("") + "</" + node.getNodeTypeName() + ">" : "/>");
}
add(SFNode.prototype, {
  toXMLString() { return element(this, ""); },
  getNodeType() { return $x3d_types(this).split(" ").filter(name => name in constants).map(name => constants[name]); },
  getFieldDefinitions() { return definitions($x3d_fields(this), name => this[name]); },
  getFields() { return this.getFieldDefinitions(); },
  getField(name) { return this[name]; },
  getFieldValue(name) { return this[name]; },
  toVRMLString() {
    const lines = [];
    for (const field of this.getFieldDefinitions())
      if (field.accessType == constants.inputOutput || field.accessType == constants.initializeOnly)
        lines.push(field.name + " " + valueText(field.typeName, field.value));
    return this.getNodeTypeName() + " { " + lines.join(" ") + " }";
  }
});
for (const Vector of [SFVec2f, SFVec2d, SFVec3f, SFVec3d, SFVec4f, SFVec4d])
  add(Vector.prototype, {
    distance(other) { return this.subtract(other).length(); },
    lerp(other, t) { return this.add(other.subtract(this).multiply(t)); }
  });
// Functions of all fields.
for (const type of fieldTypes) {
  const single = library[type], multiple = library["M" + type.substr(1)];
  for (const Class of [single, multiple]) {
    if (!Class || !Class.prototype || Class.name == "SFNode" || Class.prototype === Object.prototype) continue;
    const name = Class === single ? type : "M" + type.substr(1);
    add(Class.prototype, {
      equals(other) { return other !== null && typeof other == "object" && String(this) == String(other); },
      copy() { return new Class(this); },
      getTypeName() { return name; },
      getType() { return constants[name]; }
    });
  }
}
add(SFNode.prototype, {
  equals(other) { return this === other; },
  getTypeName() { return "SFNode"; },
  getType() { return constants.SFNode; }
});
const console = {};
for (const name of ["log", "info", "warn", "error", "debug"]) console[name] = (...texts) => Browser.println(...texts);
define("console", Object.freeze(console));
define("X3DMatrix3", library.SFMatrix3f);
define("X3DMatrix4", library.SFMatrix4f);
for (const one of [X3DExecutionContext, X3DScene]) {
  Object.freeze(one);
  Object.freeze(one.prototype);
}
})(this);
)js";
}

}  // namespace gs::app::script
