// Controls a GhostSpace that runs on this machine; needs nothing but Node.
//
//   ghostspace --control /tmp/world.socket --control-token /tmp/world.token world.wrl
//   node control.js /tmp/world.socket /tmp/world.token
//
// Protocol: docs/control.md.
'use strict';
const fs = require('fs');
const net = require('net');
const readline = require('readline');

class GhostSpace {
  constructor(path, tokenFile) {
    this.last = 0;
    this.waiting = new Map();   // calls, by id
    this.watchers = new Map();  // functions, by watch
    this.socket = net.createConnection(path);
    this.socket.write(fs.readFileSync(tokenFile, 'utf8').trim() + '\n');
    readline.createInterface({input: this.socket}).on('line', (line) => this.take(JSON.parse(line)));
  }
  take(message) {
    if (message.method === 'event') {
      const told = this.watchers.get(message.params.watch);
      if (told) told(message.params.value, message.params.time);
      return;
    }
    const call = this.waiting.get(message.id);
    if (!call) return;
    this.waiting.delete(message.id);
    if (message.error) call.reject(new Error(message.error.message));
    else call.resolve(message.result);
  }
  call(method, params = {}) {
    const id = ++this.last;
    this.socket.write(JSON.stringify({jsonrpc: '2.0', id, method, params}) + '\n');
    return new Promise((resolve, reject) => this.waiting.set(id, {resolve, reject}));
  }
  async advise(node, event, told) {
    const {watch} = await this.call('advise', {node, event});
    this.watchers.set(watch, told);
    return watch;
  }
  close() { this.socket.end(); }
}

async function main(path, tokenFile) {
  const gs = new GhostSpace(path, tokenFile);
  await gs.call('awaitWorld');
  console.log('browser:', await gs.call('getName'));
  const {nodes} = await gs.call('createVrmlFromString', {text: 'DEF Example Transform { children Shape { geometry Sphere {} } }'});
  await gs.call('replaceWorld', {nodes});
  let seen = 0;
  await gs.advise('Example', 'translation', () => ++seen);
  for (let i = 1; i <= 5; ++i)
    await gs.call('setValues', {events: [['Example', 'translation', [i, 0, 0]], ['Example', 'scale', [1, 1, i]]]});
  console.log('translation:', JSON.stringify(await gs.call('getValue', {node: 'Example', event: 'translation'})));
  console.log('seen:', seen);
  await gs.call('getNode', {node: 'None'}).catch((problem) => console.log('problem:', problem.message));
  gs.close();
}

main(...process.argv.slice(2));
