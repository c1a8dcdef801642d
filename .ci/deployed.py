"""Runs here what the units of deploy/systemd and the manifests of deploy/kubernetes run there:
the same arguments and variables, with folders and ports of this machine in the place of theirs.

usage: deployed.py LIE FOLDER, where FOLDER has cluster.pem
"""

import re
import shlex
import socket
import subprocess
import sys
from pathlib import Path

LIE, FOLDER = sys.argv[1], Path(sys.argv[2])
SCENES = Path("scenes").resolve()


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return str(server.getsockname()[1])


def farm(name, constructor, shader, view):
    """Each is arguments and environment. Renders two frames."""
    processes = []
    try:
        for arguments, environment in (constructor, shader):
            process = subprocess.Popen(
                [LIE, *arguments], env=environment, stdout=subprocess.PIPE, text=True
            )
            processes.append(process)
            line = process.stdout.readline()
            assert line.startswith("listening "), f"{name}: {arguments}: {line!r}"
        arguments, environment = view
        subprocess.run([LIE, *arguments], env=environment, check=True, timeout=60, stdout=subprocess.DEVNULL)
    finally:
        for process in reversed(processes):
            process.terminate()
            process.wait(70)
    codes = [process.returncode for process in processes]
    assert codes == [0, 0], f"{name}: {codes}"
    print(f"{name}: a constructor, a shader and a client, as deployed")


def unit(kind, instance, variables, places):
    """Arguments and environment of a unit, as systemd makes them."""
    text = Path(f"deploy/systemd/lie-{kind}@.service").read_text()
    example = Path(f"deploy/systemd/{kind}.env.example").read_text()
    environment = dict(re.findall(r"^(\w+)=(.*)$", example, re.M))
    assert variables.keys() <= environment.keys()
    for assignments in re.findall(r"^Environment=(.*)$", text, re.M):
        environment |= dict(pair.split("=", 1) for pair in assignments.split())
    command = re.search(r"^ExecStart=/usr/local/bin/lie (.*)$", text, re.M)[1]

    def specified(value):
        for specifier, place in {"%i": instance, **places}.items():
            value = value.replace(specifier, str(place))
        assert not re.search(r"%[a-zA-Z]", value), value
        return value

    environment = {key: specified(value) for key, value in environment.items()} | variables
    arguments = []
    for word in shlex.split(specified(command)):
        if re.fullmatch(r"\$\w+", word):
            arguments += environment[word[1:]].split()
        else:
            arguments.append(re.sub(r"\$\{(\w+)\}", lambda name: environment[name[1]], word))
    return arguments, environment


def systemd():
    address = "127.0.0.1:" + free_port()
    places = {"%d": FOLDER, "%S": FOLDER / "state", "%C": FOLDER / "cache"}
    (FOLDER / "state/lie-constructor/cornell").mkdir(parents=True)
    constructor = {"LIE_SCENE": str(SCENES / "cornell"), "LIE_LISTEN": address}
    bundle = ["--bundle", FOLDER / "cluster.pem"]
    view = ["view", "--constructor", address, *bundle, "--frames", "2", "--size", "32x32", "--out", FOLDER / "units"]
    farm(
        "systemd",
        unit("constructor", "cornell", constructor, places),
        unit("shader", "0", {"LIE_CONSTRUCTOR": address}, places),
        (view, {}),
    )
    assert (FOLDER / "state/lie-constructor/cornell/scene.lies").exists()
    assert list((FOLDER / "cache/lie-shader/0").iterdir())


def container(pod, places):
    """Arguments and environment of a pod's container."""
    spec = pod["spec"]["template"]["spec"]
    volumes = {volume["name"] for volume in spec["volumes"]}
    volumes |= {claim["metadata"]["name"] for claim in pod["spec"].get("volumeClaimTemplates", [])}
    [process] = spec["containers"]
    assert {mount["name"] for mount in process["volumeMounts"]} == volumes

    def placed(value):
        for there, here in places.items():
            value = value.replace(there, str(here))
        return value

    environment = {variable["name"]: placed(variable["value"]) for variable in process["env"]}
    return [placed(argument) for argument in process["args"]], environment


def kubernetes():
    try:
        import yaml
    except ImportError:
        print("!!\n!! SKIPPED: no PyYAML; what the manifests start was not run\n!!")
        return
    files = Path("deploy/kubernetes").glob("*.yaml")
    objects = [found for file in files for found in yaml.safe_load_all(file.read_text())]
    by_kind = {found["kind"]: found for found in objects}
    port, shader_port = free_port(), free_port()
    places = {
        "0.0.0.0:7400": "127.0.0.1:" + port,
        "0.0.0.0:7410": "127.0.0.1:" + shader_port,
        "lie-constructor:7400": "127.0.0.1:" + port,
        "/scenes/gallery": SCENES / "cornell",
        "/run/secrets/lie": FOLDER,
        "/var/lib/lie": FOLDER / "claim",
        "/var/cache/lie": FOLDER / "empty",
        "/frames": FOLDER / "frames",
        # Here there is one shader, and little time.
        "--wait-shaders=2": "--wait-shaders=1",
        "--frames=60": "--frames=2",
    }
    (FOLDER / "claim").mkdir()
    constructor = by_kind["StatefulSet"]
    service = by_kind["Service"]
    labels = constructor["spec"]["template"]["metadata"]["labels"]
    assert service["spec"]["selector"].items() <= labels.items()
    assert service["metadata"]["name"] == "lie-constructor"
    assert service["spec"]["ports"][0]["port"] == 7400
    farm(
        "kubernetes",
        container(constructor, places),
        container(by_kind["Deployment"], places),
        container(by_kind["Job"], places),
    )
    assert len(list((FOLDER / "frames").glob("frame-*.png"))) == 2


systemd()
kubernetes()
