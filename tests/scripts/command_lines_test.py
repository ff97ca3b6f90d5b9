"""Tests what every program prints about its own command line, and its completion in real shells.

usage: command_lines_test.py CASE [SHELL] PROGRAM...
"""
import os
import pty
import re
import select
import shlex
import subprocess
import sys
import tempfile
import time

# For a shell that hangs; a shell that works needs a fraction of a second.
PATIENCE_S = 60


def fail(message):
    sys.exit(message)


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    return done.returncode, done.stdout, done.stderr


def output_of(*command):
    code, out, err = run(*command)
    if code != 0:
        fail(f"{shlex.join(command)}: exit code {code}: {out}{err}")
    return out


def section(page, title):
    """The lines of a section of --help."""
    found = re.search(rf"^{title}:\n((?:.+\n)+)", page, re.MULTILINE)
    return found.group(1).splitlines() if found else []


def options_of(page):
    """The names of all options of --help."""
    lines = page.split("\nExamples:")[0].splitlines()
    names = [name for line in lines if re.match(r"  -", line) for name in line.split()[0].split(",")]
    return set(names)


def pages_of(program):
    """--help of the program ("") and of its commands."""
    pages = {"": output_of(program, "--help")}
    for line in section(pages[""], "Subcommands"):
        if command := re.match(r"  ([a-z]+)", line):
            pages[command.group(1)] = output_of(program, command.group(1), "--help")
    return pages


def check_example(name, pages, example):
    words = shlex.split(example)
    if words[0] == "sudo":
        words = words[3:] if words[1] == "-u" else words[1:]
    if words[0] != name:
        fail(f"the example begins with {words[0]}: {example}")
    command = words[1] if len(words) > 1 and words[1] in pages else ""
    # A program with commands may also do something without one.
    if "" in pages and len(pages) > 1 and not command and not words[1].startswith("--"):
        fail(f"no such command: {example}")
    for word in words[1:]:
        if re.match(r"--?[a-z]", word) and word.split("=")[0] not in options_of(pages[command]):
            fail(f"{word} is no option: {example}")


def DeclaresItsCommandLine(program):
    name = os.path.basename(program)
    pages = pages_of(program)
    for command, page in pages.items():
        where = f"{name} {command}".strip()
        examples = [line.strip() for line in section(page, "Examples") if re.match(r"  [^ ]", line)]
        if not examples:
            fail(f"{where} --help has no examples: {page}")
        for example in examples:
            check_example(name, pages, example)
        code, _, err = run(*where.replace(name, program, 1).split(), "--no-such-option")
        if code != 64 or '"--no-such-option" is no option' not in err:
            fail(f"{where} --no-such-option: exit code {code}: {err}")
    if not {"--help", "--version", "--completion"} <= options_of(pages[""]):
        fail(f"an option that every program has is missing: {pages['']}")
    if not re.fullmatch(re.escape(name) + r" \d+\.\d+\.\d+\n", output_of(program, "--version")):
        fail(f"--version prints {output_of(program, '--version')}")
    code, _, err = run(program, "--versoin")
    if code != 64 or 'did you mean "--version"?' not in err:
        fail(f"a mistyped option is not corrected: {err}")


def bash_words(script, words):
    """What bash offers for the last word."""
    call = f'source {shlex.quote(script)}\nCOMP_WORDS=({shlex.join(words)}) COMP_CWORD={len(words) - 1}\n'
    call += '"$(complete -p | sed -n "s/.*-F \\([^ ]*\\) .*/\\1/p")"\nprintf "%s\\n" "${COMPREPLY[@]}"'
    return set(output_of("bash", "--norc", "-c", call).split())


def CompletesEveryOption(program):
    name = os.path.basename(program)
    with tempfile.TemporaryDirectory() as folder:
        script = os.path.join(folder, name)
        write(script, output_of(program, "--completion", "bash"))
        zsh = output_of(program, "--completion", "zsh")
        pages = pages_of(program)
        for command, page in pages.items():
            words = [name, command, "-"] if command else [name, "-"]
            offered = bash_words(script, words)
            if offered != options_of(page):
                fail(f"{shlex.join(words)}: bash offers {offered}, --help {options_of(page)}")
            # The options of a command stand between its name and the end of its branch.
            part = zsh.split(f"\n        {command})\n")[1].split(";;")[0] if command else zsh.split("case $state")[0]
            listed = set(re.findall(r"^ +'\*?(--?[a-z-]+)=?\[", part, re.MULTILINE))
            if listed != options_of(page):
                fail(f"{shlex.join(words)}: zsh offers {listed}, --help {options_of(page)}")
        commands = set(pages) - {""}
        # A program with commands can have words to choose from in the place of the command.
        words = re.search(r"^ +[a-z]+ TEXT:\{(.*)\}", pages[""], re.MULTILINE)
        expected = commands | set(words[1].split(",") if words else [])
        if commands and bash_words(script, [name, ""]) != expected:
            fail(f"bash offers {bash_words(script, [name, ''])} as first words instead of {expected}")


class Terminal:
    """An interactive shell."""

    def __init__(self, command, folder):
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.environ.update(TERM="xterm", HISTFILE="/dev/null", HOME=folder, PS1="$ ")
            os.execvp(command[0], command)
        self.text = ""

    def type(self, keys):
        os.write(self.terminal, keys.encode())

    def wait_for(self, text):
        """Reads until the text appears, and returns what came before it."""
        end = time.monotonic() + PATIENCE_S
        while text not in self.text:
            if not select.select([self.terminal], [], [], max(0, end - time.monotonic()))[0]:
                fail(f"{text!r} did not appear: {self.text!r}")
            self.text += os.read(self.terminal, 4096).decode(errors="replace")
        before, self.text = self.text.split(text, 1)
        return before

    def close(self):
        os.close(self.terminal)
        os.waitpid(self.process, 0)


START = {
    "bash": ["bash", "--norc", "--noprofile", "-i"],
    "zsh": ["zsh", "-f", "-i"],
}

# What is typed, and the words that the program gets. The tab stands where it is pressed.
TYPED = [
    ("touchline ru\t--headl\t", "run --headless"),
    ("touchline run --boa\tmock\t--pace f\t", "run --board mock.toml --pace fast"),
    ("touchline run --pace=re\t", "run --pace=real"),
    ("touchline run --publish ssl-t\t", "run --publish ssl-tracked"),
    ("touchline check --board 'a f\t", "check --board a file.toml"),
    ("touchline init --out fold\t", "init --out folder"),
    ("touchline init --league mir\t", "init --league mirosot"),
    ("touchline --comp\tz\t", "--completion zsh"),
    ("touchline-calibrate fi\t--pict\tmock\t", "field --picture mock.toml"),
    ("touchline-arena lay\t--out fold\t", "layouts --out folder"),
    ("touchline-arena ser\t--pic\tnone --lockst\t", "serve --pictures none --lockstep"),
    ("touchline-replay mock\t--venue mock\t", "mock.toml --venue mock.toml"),
    ("touchline-latency --plant pree\t5", "--plant preemption=5"),
    ("touchline-devices --gp\t--json", "--gpio --json"),
]


def plain(words):
    """Zsh joins an option and its value with an equal sign, and takes the slash of a folder back."""
    return re.sub(r"(--[a-z]+)=", r"\1 ", words).rstrip("/")


def CompletesWhatIsTyped(shell, *programs):
    by_name = {os.path.basename(program): program for program in programs}
    with tempfile.TemporaryDirectory() as folder:
        for file in ("mock.toml", "a file.toml"):
            write(os.path.join(folder, file), "")
        for inner in ("folder", "functions"):
            os.mkdir(os.path.join(folder, inner))
        with open(os.path.join(folder, "start"), "w", encoding="utf-8") as file:
            if shell == "zsh":
                file.write("fpath=($PWD/functions $fpath)\nautoload -Uz compinit && compinit -D -u\n")
            for name, program in by_name.items():
                # In place of the program a function shows the words that it gets.
                file.write(f'{name}() {{ echo "got:$* :end"; }}\n')
                # As an installed file, and as a person does without one.
                if shell == "zsh" and name != "touchline":
                    write(os.path.join(folder, "functions", "_" + name), output_of(program, "--completion", shell))
                else:
                    file.write(f"source <({shlex.quote(program)} --completion {shell})\n")
            file.write("bindkey -e\n" if shell == "zsh" else "bind 'set enable-bracketed-paste off'\n")
            file.write("rm start\necho read\"y\"\n")
        terminal = Terminal(START[shell], folder)
        terminal.type("source ./start\n")
        terminal.wait_for("ready")
        for typed, expected in TYPED:
            terminal.type(typed + "\n")
            terminal.wait_for("got:")
            got = terminal.wait_for(":end").strip()
            if plain(got) != plain(expected):
                fail(f"{shell}: {typed!r} became {got!r} instead of {expected!r}")
        terminal.close()


globals()[sys.argv[1]](*sys.argv[2:])
