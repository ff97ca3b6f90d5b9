// The page's modules import each other in one direction, imports of types included. Node starts this in its folder.
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { posix } from 'node:path';
import { test } from 'node:test';

const SOURCES = '../../../tools/console/src';

/** Modules by their path, with the paths that they import. */
type Imports = Map<string, string[]>;

/** Reads static and dynamic imports of other files of the page. */
function importsOf(files: Map<string, string>): Imports {
  const imports: Imports = new Map();
  for (const [path, text] of files) {
    const found: string[] = [];
    for (const [, name] of text.matchAll(/(?:\bfrom|\bimport)\s*\(?\s*'(\.[^']+)'/g)) {
      const target = posix.join(posix.dirname(path), name!);
      const file = [target, `${target}.ts`].find((candidate) => files.has(candidate));
      assert.ok(file || target.endsWith('.css'), `${path} imports ${name}, which does not exist`);
      if (file) found.push(file);
    }
    imports.set(path, found);
  }
  return imports;
}

/** Returns the modules of a circle in the order in which they import each other, or null. */
function circleIn(imports: Imports): string[] | null {
  const done = new Set<string>();
  const visit = (path: string, above: string[]): string[] | null => {
    if (above.includes(path)) return [...above.slice(above.indexOf(path)), path];
    if (done.has(path)) return null;
    done.add(path);
    for (const next of imports.get(path) ?? []) {
      const circle = visit(next, [...above, path]);
      if (circle) return circle;
    }
    return null;
  };
  for (const path of imports.keys()) {
    const circle = visit(path, []);
    if (circle) return circle;
  }
  return null;
}

test('the modules of the page import each other in one direction', () => {
  const files = new Map<string, string>();
  for (const path of readdirSync(SOURCES, { recursive: true, encoding: 'utf8' })) {
    if (/\.(ts|svelte)$/.test(path)) files.set(path, readFileSync(`${SOURCES}/${path}`, 'utf8'));
  }
  const imports = importsOf(files);
  assert.deepEqual(circleIn(imports), null);
  // The check must not pass because it read nothing.
  assert.ok(imports.size > 40, `${imports.size} files`);
  assert.ok(imports.get('lib/session.svelte.ts')!.includes('lib/connection.ts'));
  assert.ok(imports.get('App.svelte')!.includes('pages/TimingPage.svelte'), 'an import at run time');
});

test('a planted circle of types is found', () => {
  const files = new Map([
    ['main.ts', "import { a } from './lib/a';"],
    ['lib/a.ts', "import { mount } from 'svelte';\nimport type { B } from './b';"],
    ['lib/b.ts', "import Part from '../parts/Part.svelte';"],
    ['parts/Part.svelte', "export { a } from '../lib/a';"],
  ]);
  assert.deepEqual(circleIn(importsOf(files)), ['lib/a.ts', 'lib/b.ts', 'parts/Part.svelte', 'lib/a.ts']);
  files.set('parts/Part.svelte', '');
  assert.equal(circleIn(importsOf(files)), null);
});
