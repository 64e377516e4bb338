#include "tests/fuzz/scripts/script_grammar.h"

namespace gs::fuzz {

std::uint64_t Random::next() {
  std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

std::string Random::pick(std::initializer_list<const char*> texts) {
  return texts.begin()[below(static_cast<int>(texts.size()))];
}

// Appends a line of a program. In a nested Script, a program is a sum of strings, one per line.
void ScriptGrammar::line(const std::string& text) { out_ += nested_ ? "'" + text + " ' +\n" : text + "\n"; }

void ScriptGrammar::block(int most) {
  ++depth_;
  for (int i = 1 + random_.below(most); i > 0; --i) statement();
  --depth_;
}

void ScriptGrammar::function(const std::string& head, const std::string& tail, const std::string& result) {
  line(head);
  line("if (++calls > 150) return" + (result.empty() ? std::string() : " " + result) + ";");
  block();
  if (!result.empty()) line("return " + result + ";");
  line(tail);
}

// ---- Expressions. If they need variables, they first append the statements that set them.

std::string ScriptGrammar::number() {
  if (depth_ < kDeepest && random_.once_in(4)) return hostile();
  return random_.pick({"0",   "1",          "2",          "-1",          "0.5",  "7",         "1e9",
                       "NaN", "1e300",      "-Infinity",  "calls",       "null", "undefined", "true",
                       "v",   "undeclared", "pts.length", "kids.length", "me",   "4294967295"});
}

std::string ScriptGrammar::text() {
  if (depth_ < kDeepest && random_.once_in(4)) return hostile();
  switch (random_.below(6)) {
    case 0:
      return kept();
    case 1:
      return "strs[0]";
    case 2:
      return "s";
    case 3:
      return url();
    default:
      return quoted(random_.pick({"", "x", "0 0 0", "children", "url"}));
  }
}

std::string ScriptGrammar::url() {
  return quoted(random_.pick(
      {"part0.wrl", "part1.wrl", "part0.wrl", "missing.wrl", "program.js", "memory://b/other.wrl", "",
       "javascript: function tick(e) { kids = Browser.keep; }", "javascript: var keep = []; throw keep;",
       "javascript: function initialize() { n = me; kids = mine; } function shutdown() { n = node; }", "world.wrl",
       "data:model/vrml,%23VRML%20V2.0%20utf8%0AGroup%20%7B%20children%20Group%20%7B%20%7D%20%7D%0A"}));
}

std::string ScriptGrammar::vector() {
  switch (random_.below(11)) {
    case 0:
      return "new SFVec3f(" + number() + ", " + number() + ", " + number() + ")";
    case 1:
      return "new SFRotation(" + number() + ", 1, 0, " + number() + ")";
    case 2:
      return "v";
    case 3:
      return "pts[" + random_.pick({"0", "1", "9"}) + "]";
    case 4:
      return node() + ".translation";
    case 5:
      return kept();
    case 6:
      return "v." + random_.pick({"add", "subtract", "cross"}) + "(v)";
    case 7:
      return "v.multiply(" + number() + ")";
    case 8:
      return "new SFColor(" + number() + ", 0, 1)";
    default:
      return depth_ < kDeepest ? hostile_array() : "[1, 2, 3]";
  }
}

std::string ScriptGrammar::node() {
  if (random_.once_in(5)) return kept();
  return random_.pick({"me", "node", "other", "inl", "(n || node)", "kids[0]", "mine[0]", "mine[1]", "mine[2]", "view",
                       "(node.children[0] || node)", "make(1)[0]", "(Browser.n || me)", "other.mine[0]", "clock",
                       "node"});
}

std::string ScriptGrammar::list() {
  switch (random_.below(12)) {
    case 0:
      return kept();
    case 1:
      return "make(" + random_.pick({"1", "3", "40"}) + ")";
    case 2:
      return "new MFNode(" + node() + ", " + node() + ")";
    case 3:
      return "new MFVec3f(" + vector() + ", " + vector() + ")";
    case 4:
      return "new MFString(" + text() + ", " + text() + ")";
    case 5:
      return "[" + node() + ", " + node() + "]";
    case 6:
      return node() + ".children";
    case 7:
      return depth_ < kDeepest ? hostile_array() : "[]";
    case 8:
      return "other." + random_.pick({"kids", "pts", "mine", "strs"});
    default:
      return random_.pick({"kids", "pts", "strs", "mine", "nums", "cols", "flats", "times", "rots", "ints", "path"});
  }
}

std::string ScriptGrammar::any() {
  switch (random_.below(6)) {
    case 0:
      return vector();
    case 1:
      return node();
    case 2:
      return list();
    case 3:
      return number();
    case 4:
      return random_.pick({"e", "img", "img.array", "gen", "use", "Browser", "this", "new VrmlMatrix()", "rot"});
    default:
      return kept();
  }
}

// Returns an object that runs statements when it is converted.
std::string ScriptGrammar::hostile() {
  const std::string name = fresh();
  line("var " + name + " = {");
  const std::string result = random_.pick({"1", "0", "me", "null", "pts.length"});
  const std::string method = random_.pick({"valueOf", "valueOf", "toString"});
  function(method + ": function () {", "}", result);
  line("};");
  return name;
}

std::string ScriptGrammar::hostile_array() {
  const std::string name = fresh();
  switch (random_.below(7)) {
    case 0:
      line("var " + name + " = [" + random_.pick({"", "1, 2", "node", "v, v"}) + "]; " + name + "[" +
           random_.pick({"0", "0", "1"}) + "] = " + name + ";");
      break;
    case 1:
      line("var " + name + " = []; for (var i = 0; i < " + random_.pick({"30", "30000"}) + "; i++) " + name + " = [" +
           name + "];");
      break;
    case 2:
      line("var " + name + " = [1, 2, 3]; " + name + ".length = " + random_.pick({"0", "50000", "4294967295"}) + ";");
      break;
    case 3:
    case 4: {
      line("var " + name + " = [1, 2, 3];");
      const std::string result = any();
      function("Object.defineProperty(" + name + ", " + random_.pick({"0", "1", "2"}) + ", { get: function () {",
               "} });", result);
      break;
    }
    case 5: {
      function("var " + name + " = new Proxy([1, 2, 3], { get: function (t, k) {", "} });", "t[k]");
      break;
    }
    default:
      line("var " + name + " = [" + number() + ", " + number() + ", " + any() + "];");
  }
  return name;
}

std::string ScriptGrammar::nodes_text() {
  return random_.pick(
      {"Transform { children Group { } }", "Group { children [ DEF Q Transform { } USE Q USE Q ] }",
       "Inline { url \\\"part0.wrl\\\" }",
       "DEF A Transform { } DEF B Transform { } ROUTE A.translation TO B.translation",
       "PROTO M [ exposedField SFVec3f p 0 0 0 ] { DEF X Transform { translation IS p } } M { } M { }", "Viewpoint { }",
       "TimeSensor { loop TRUE cycleInterval 0.05 }", "Shape { geometry Box { } }", "TouchSensor { } Shape { }",
       "Broken {", "EXTERNPROTO P [ eventIn SFTime tick ] \\\"part0.wrl#P\\\" P { } P { }",
       "Script { url \\\"program.js\\\" }", "Script { url \\\"javascript: function shutdown() { print(1); }\\\" }"});
}

// ---- Statements

void ScriptGrammar::statement() {
  if (depth_ > kDeepest) return simple();
  if (!random_.once_in(3)) {
    line("try {");
    simple();
    if (random_.once_in(2)) simple();
    line("} catch (x) { " + random_.pick({"", "", "use(x);", "n = me;", "throw x;"}) + " }");
    return;
  }
  simple();
}

void ScriptGrammar::simple() {
  int kind = random_.below(kFirstRare);
  while (kind > 0 && !has(kind)) kind = random_.below(kFirstRare);
  switch (kind) {
    case 0:
    case 1:
    case 2:
      return assignment();
    case 3:
    case 4:
    case 5:
      return node_write();
    case 6:
    case 7:
      return list_call();
    case 8:
    case 9:
      return browser_call();
    case 10:
      return later();
    case 11:
      return abuse();
    case 12:
      return line("print(" + quote_ + "gc" + quote_ + ");");
    case 13:
      return line("use(" + any() + ");");
    case 14:
      return line("hold(" + any() + ");");
    default:
      return line("Browser." + random_.pick({"n", "x", "keep"}) + " = " + any() + ";");
  }
}

void ScriptGrammar::assignment() {
  switch (random_.below(12)) {
    case 0:
      return line("v = " + vector() + ";");
    case 1:
      return line(random_.pick({"c", "r", "flat", "at"}) + " = " + vector() + ";");
    case 2:
      return line("n = " + node() + ";");
    case 3:
      return line(random_.pick({"kids", "mine"}) + " = " + list() + ";");
    case 4:
      return line(random_.pick({"pts", "cols", "rots", "flats", "path"}) + " = " + list() + ";");
    case 5:
      return line(random_.pick({"strs", "nums", "ints", "times", "words"}) + " = " + list() + ";");
    case 6:
      return line(random_.pick({"i", "f", "t", "b"}) + " = " + number() + ";");
    case 7:
      return line("s = " + text() + ";");
    case 8:
      return line(list() + "[" + random_.pick({"0", "1", "5", "300"}) + "] = " + any() + ";");
    case 9:
      return line(list() + ".length = " + random_.pick({"0", "1", "4", "200", "v"}) + ";");
    case 10:
      return line(vector() + random_.pick({".x", ".y", ".angle", "[0]"}) + " = " + number() + ";");
    default:
      return line(random_.once_in(2) ? "img = new SFImage(2, 1, 3, " + list() + ");"
                                     : "img.array[" + random_.pick({"0", "1", "9"}) + "] = " + number() + ";");
  }
}

void ScriptGrammar::node_write() {
  const std::string target = node();
  switch (random_.below(12)) {
    case 0:
      return line(target + ".children = " + list() + ";");
    case 1:
      return line(target + "." + random_.pick({"addChildren", "removeChildren"}) + " = " + list() + ";");
    case 2:
      return line(target + ".translation = " + vector() + ";");
    case 3:
      return line(target + ".translation.x = " + number() + ";");
    case 4:
      return line(target + ".children[" + random_.pick({"0", "1", "20"}) + "] = " + node() + ";");
    case 5:
      return line(target + ".children.length = " + random_.pick({"0", "1", "3"}) + ";");
    case 6:
    case 7:
      if (!has(kSetUrl)) return line(target + ".children = make(2);");
      if (random_.once_in(2)) return line("inl.url = new MFString(" + url() + ");");
      return line(random_.pick({"me", "other", "me", "other", "n"}) + ".url = new MFString(" + url() + ");");
    case 8:
      return line(target + "." + random_.pick({"set_bind", "enabled", "loop"}) + " = " + number() + ";");
    case 9:
      return line(target + "." + random_.pick({"tick", "go", "nodes", "one", "points"}) + " = " + any() + ";");
    case 10:
      return line("node.removeChildren = node.children; node.addChildren = " + list() + ";");
    default:
      return line(target + ".url = " + list() + ";");
  }
}

void ScriptGrammar::list_call() {
  const std::string of = list();
  switch (random_.below(8)) {
    case 0:
      return function(of + "." + random_.pick({"forEach", "map", "filter", "some"}) + "(function (x, k, l) {", "});",
                      "1");
    case 1:
      return function(of + ".sort(function (x, y) {", "});", random_.pick({"0", "1", "-1"}));
    case 2:
      return line(of + ".splice(" + number() + ", " + number() + ", " + any() + ");");
    case 3:
      return line(of + "." + random_.pick({"push", "unshift", "fill", "concat", "indexOf"}) + "(" + any() + ");");
    case 4:
      return line(of + "." + random_.pick({"reverse", "pop", "shift", "slice", "join", "toString"}) + "();");
    case 5:
      return line("for (var k in " + of + ") { " + random_.pick({"kids.length = 0;", "use(k);", "pts[k] = v;"}) + " }");
    case 6:
      return line("Object." + random_.pick({"freeze", "keys", "values", "getOwnPropertyDescriptors"}) + "(" + of +
                  ");");
    default:
      return line("Reflect.set(" + of + ", 0, " + any() + ", " + any() + ");");
  }
}

// Appends statements that run later, when the function, its Script or its world may no longer exist.
void ScriptGrammar::later() {
  switch (random_.below(7)) {
    case 0:
      return function("Promise.resolve(" + any() + ").then(function (x) {", "});", "");
    case 1:
      return function("new Promise(function (go) { hold(go); }).then(function (x) {", "});", "");
    case 2: {
      function("gen = (function* () {", "", "");
      line("yield " + any() + ";");
      block();
      return line("})(); hold(gen); gen.next();");
    }
    case 3:
      return line("use(" + random_.pick({"gen", "Browser.gen"}) + "); Browser.gen = gen;");
    case 4: {
      line("(async function () {");
      line(random_.once_in(2) ? "await " + any() + ";" : "await new Promise(function (go) { hold(go); });");
      block();
      line("await null;");
      block();
      return line("})();");
    }
    case 5:
      return function("hold(function (x) {", "});", "x");
    default:
      return function("Promise.resolve({ then: function (go) {", "} });", "go(me)");
  }
}

void ScriptGrammar::abuse() {
  const std::string name = fresh();
  switch (random_.below(10)) {
    case 0:
      return function("this.__defineGetter__(" + quoted(random_.pick({"lines", "on", "eventsProcessed", "shutdown"})) +
                          ", function () {",
                      "});", "use");
    case 1:
      return line((has(kThrow) ? "throw " : "use(") + any() + (has(kThrow) ? ";" : ");"));
    case 2:
      return line("(function " + name + "() { " + name + "(); })();");
    case 3:
      return line("var " + name + " = { valueOf: function () { v.x = " + name + "; return 1; } }; v.x = " + name + ";");
    case 4:
      if (!nested_ && endless_++ == 0 && random_.once_in(4)) return line("for (;;) use(me);");
      return line("var " + name + " = []; for (var i = 0; i < 300; i++) " + name + ".push(new SFVec3f(i, i, i), [i]);");
    case 5:
      if (!has(kPrototypes)) return line("use(" + any() + ");");
      return function(random_.pick({"SFVec3f", "MFNode", "Array", "Object", "SFNode"}) + ".prototype." +
                          random_.pick({"toString", "valueOf", "then", "x"}) + " = function () {",
                      "};", "1");
    case 6:
      return line("Object.setPrototypeOf(" + any() + ", " + any() + ");");
    case 7:
      return line("var " + name + " = new VrmlMatrix(); hold(" + name + "[1]); " + name + "[0][1] = " + number() + ";");
    case 8:
      return line("tick(" + any() + ", 0);");
    default:
      return line("delete " + list() + "[0];");
  }
}

// Appends statements that make a Script, with a program as text.
void ScriptGrammar::nested_script() {
  out_ += "hold(Browser.createVrmlFromString(\n";
  nested_ = true;
  quote_ = "`";
  const int depth = depth_;
  depth_ = kDeepest - 1;
  line("Script { directOutput TRUE field SFNode node Transform { } field MFNode mine [ ] eventIn SFTime tick");
  line("eventOut SFVec3f v eventOut SFNode n eventOut MFNode kids eventOut MFVec3f pts");
  line("url \\\"javascript: var calls = 0, keep = [], me = node;");
  line("function kept(k) { return Browser.keep[k]; } function hold(x) { Browser.keep.push(x); }");
  line("function use(x) { return x.length + x[0]; } function make(k) { return Browser.keep; }");
  for (const char* name : {"initialize", "tick", "shutdown"})
    if (!random_.once_in(3)) function("function " + std::string(name) + "(e) {", "}", "");
  line("\\\" }");
  nested_ = false;
  quote_ = "'";
  depth_ = depth;
  out_ += "''));\n";
}

void ScriptGrammar::program() {
  line("var keep = [], calls = 0, made = 0, gen = null, rot = null;");
  line(
      "function kept(k) { var a = Browser.keep && k % 2 ? Browser.keep : keep; return a.length ? a[k % a.length] : me; "
      "}");
  line(
      "function hold(x) { if (keep.length < 40) keep.push(x); if (!Browser.keep) Browser.keep = [];"
      " if (Browser.keep.length < 40) Browser.keep.push(x); return x; }");
  line(
      "function make(k) { if (++made > 12) return kids; var a = 'Transform { children Group { } } ', all = '';"
      " while (k-- > 0) all += a; return Browser.createVrmlFromString(all); }");
  line(
      "function use(x) { if (x === null || x === undefined) return x; if (typeof x == 'function') return x(me);"
      " if (x.next) return x.next(); String(x); x[0] = x[1]; x.x = x.y; for (var k in x) x[k];"
      " x.length = 1; x[2] = x[0]; if (x.children) x.children = []; return x; }");
  if (random_.once_in(3)) block(2);
  for (const char* name :
       {"initialize", "shutdown", "eventsProcessed", "tick", "go", "place", "nodes", "one", "points", "word"})
    if (!random_.once_in(3)) function("function " + std::string(name) + "(e, time) {", "}", "");
}

}  // namespace gs::fuzz
