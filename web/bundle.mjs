// SPDX-License-Identifier: BSD-3-Clause
// Makes viewer.html, which modules/web compiles in: all of web/ as one text without comments and indentation.
//   node web/bundle.mjs            writes it
//   node web/bundle.mjs --check    exits 1 if it is not current
import {readFileSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const web = dirname(fileURLToPath(import.meta.url)), read = name => readFileSync(join(web, name), 'utf8');
const MODULES = ['vectors.js', 'surface.js', 'rays.js', 'camera.js', 'shaders.js', 'frames.js', 'renderer.js', 'splats.js', 'viewer.js', 'ui.js'];

/** Shader texts that the viewer shares with visualization/: the raw strings there, by their names. */
export function sharedShaders() {
  const shared = {};
  for (const name of ['leaf_glsl', 'pass_glsl']) {
    const source = read(`../visualization/src/opengl/${name}.cpp`);
    for (const [, id, text] of source.matchAll(/char\* (?:const )?(k\w+) = R"\(([^]*?)\)";/g)) shared[id] = text;
  }
  return shared;
}

/** Without comments, indentation and empty lines. Strings in web/ contain no comment marks. */
const stripped = text => text.replace(/\/\*[^]*?\*\//g, '').replace(/^\s*\/\/.*$/gm, '').replace(/ +\/\/ .*$/gm, '')
  .replace(/^\s+/gm, '').replace(/\n+/g, '\n');

function bundle() {
  const glsl = Object.entries(sharedShaders()) .map(([id, text]) => `${id}: \`${stripped(text)}\``);
  const code = MODULES.map(read).join('\n').replace(/^import .*$/gm, '').replace(/^export /gm, '');
  const script = `'use strict';(()=>{\nconst SHARED={${glsl.join(',\n')}};\n${stripped(code)}})();`;
  const page = stripped(read('page.html').replace('/*viewer*/', 'VIEWER'));
  return page.replace('VIEWER', () => script);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const text = bundle(), place = join(web, 'viewer.html');
  if (process.argv[2] === '--check') {
    if (readFileSync(place, 'utf8') !== text) {
      console.error('web/viewer.html is not current: run node web/bundle.mjs');
      process.exit(1);
    }
  } else {
    writeFileSync(place, text);
    console.log(`${place}: ${text.length} bytes`);
  }
}
