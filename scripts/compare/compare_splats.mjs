// compare_splats.mjs [--default] FILE X,Y,Z OUT: draws a file of Gaussian splats from X,Y,Z along -z at 1024x768 with
// Spark in headless Chromium and with GhostSpace. Writes OUT.spark.png and OUT.png, and prints their PSNR in dB.
//
// Without --default, Spark draws as the rasteriser of 3DGS: a low-pass without compensation, ellipses that end at the
// opacity 1/255, a maximum opacity of 0.99, and neither 8-bit splats nor an 8-bit canvas. Spark reads the same file, but
// a SOG only as an archive.
//
// Environment: PEERS_HOME with npm/node_modules of puppeteer-core, three and @sparkjsdev/spark; GHOSTSPACE, the program
// (build/release/ghostspace). Needs Chromium and ImageMagick.
import {execFileSync} from 'child_process';
import fs from 'fs';
import http from 'http';
import {createRequire} from 'module';
import path from 'path';

const words = process.argv.slice(2), asDefault = words[0] === '--default';
const [file, place, out] = asDefault ? words.slice(1) : words;
if (!out) throw new Error('usage: compare_splats.mjs [--default] FILE X,Y,Z OUT');
const modules = path.join(process.env.PEERS_HOME, 'npm', 'node_modules');
const [width, height] = [1024, 768];

const page = `<!doctype html><script type="importmap">{"imports": {
  "three": "/npm/three/build/three.module.js", "three/addons/": "/npm/three/examples/jsm/",
  "spark": "/npm/@sparkjsdev/spark/dist/spark.module.js"}}</script><script type="module">
try {
  const THREE = await import('three'), {SparkRenderer, SplatMesh} = await import('spark');
  const renderer = new THREE.WebGLRenderer({antialias: false, preserveDrawingBuffer: true});
  renderer.setPixelRatio(1);
  renderer.setSize(${width}, ${height}, false);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0, 0, 0);
  const camera = new THREE.PerspectiveCamera(45, ${width} / ${height}, 0.01, 1000);
  camera.position.set(${place});
  const as3dgs = {preBlurAmount: 0.3, blurAmount: 0, maxStdDev: Math.sqrt(2 * Math.log(255)), minAlpha: 1 / 255,
                  accumExtSplats: true};
  const spark = new SparkRenderer({renderer, ...(${asDefault} ? {} : as3dgs)});
  if (!${asDefault})
    spark.material.fragmentShader = spark.material.fragmentShader
      .replace('if (encodeLinear)', 'if (false)')
      .replace('if (rgba.a < minAlpha)', 'rgba.a = min(rgba.a, 0.99); if (rgba.a < minAlpha)');
  const splats = new SplatMesh({url: '/file/' + ${JSON.stringify(path.basename(file))}, extSplats: true, lod: false});
  splats.quaternion.set(1, 0, 0, 0);
  scene.add(spark, splats);
  await splats.initialized;
  const small = new THREE.WebGLRenderTarget(8, 6);
  for (let i = 0; i < 3; ++i) {  // starts the sort, and waits for it
    renderer.setRenderTarget(small);
    renderer.render(scene, camera);
    do await new Promise(done => setTimeout(done, 200));
    while (spark.sorting || spark.sortDirty);
  }
  const target = ${asDefault} ? null : new THREE.WebGLRenderTarget(${width}, ${height}, {type: THREE.FloatType});
  const gl = renderer.getContext();
  gl.getExtension('EXT_float_blend');
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  let bytes = new Uint8Array(4 * ${width} * ${height});
  if (target) {
    const numbers = new Float32Array(bytes.length);
    renderer.readRenderTargetPixels(target, 0, 0, ${width}, ${height}, numbers);
    bytes = Uint8Array.from(numbers, v => Math.round(255 * Math.min(Math.max(v, 0), 1)));
  } else {
    gl.readPixels(0, 0, ${width}, ${height}, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  }
  await fetch('/picture', {method: 'POST', body: bytes});
} catch (error) {
  await fetch('/error', {method: 'POST', body: String(error)});
}
</script>`;

const received = {};
let finished;
const done = new Promise(resolve => { finished = resolve; });
const types = {'.js': 'text/javascript', '.wasm': 'application/wasm'};
const server = http.createServer((request, response) => {
  const name = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
  if (request.method === 'POST') {
    const parts = [];
    request.on('data', part => parts.push(part));
    request.on('end', () => {
      received[name] = Buffer.concat(parts);
      response.end();
      finished();
    });
    return;
  }
  const served = name.startsWith('/npm/') ? path.join(modules, name.slice(5)) : name.startsWith('/file/') ? file : null;
  response.setHeader('content-type', served ? types[path.extname(served)] ?? 'application/octet-stream' : 'text/html');
  if (!served) response.end(page);
  else fs.createReadStream(served).on('error', () => response.writeHead(404).end()).pipe(response);
});
await new Promise(ready => server.listen(0, '127.0.0.1', ready));

const puppeteer = createRequire(path.join(modules, 'x.js'))('puppeteer-core');
const browser = await puppeteer.launch({
  executablePath: '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
         '--disable-gpu-watchdog', '--disable-dev-shm-usage']});
const tab = await browser.newPage();
await tab.goto(`http://127.0.0.1:${server.address().port}/`);
await done;
await browser.close();
server.close();
if (received['/error']) throw new Error(received['/error']);

const raw = ['-size', `${width}x${height}`, '-depth', '8', 'rgba:-', '-flip', '-alpha', 'off'];
execFileSync('convert', [...raw, `${out}.spark.png`], {input: received['/picture']});
const [x, y, z] = place.split(',');
execFileSync(process.env.GHOSTSPACE ?? 'build/release/ghostspace', [
  '--snapshot', `${out}.png`, '--size', `${width}x${height}`, '--background', '0,0,0', '--camera',
  `position=${x},${y},${z} orientation=0,0,1,0 fieldOfView=0.785398`, file], {stdio: ['ignore', 'ignore', 'inherit']});
const pixels = name => execFileSync('convert', [name, '-depth', '8', 'rgb:-'], {maxBuffer: 1 << 26});
const [a, b] = [pixels(`${out}.spark.png`), pixels(`${out}.png`)];
let sum = 0;
for (let i = 0; i < a.length; ++i) sum += (a[i] - b[i]) ** 2;
console.log(`${(10 * Math.log10(255 * 255 * a.length / sum)).toFixed(1)} dB`);
process.exit(0);
