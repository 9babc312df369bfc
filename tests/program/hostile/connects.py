import socket


def build(scene):
    with socket.create_connection(("127.0.0.1", int(scene.param("port", 1.0))), timeout=2.0) as connection:
        connection.sendall(b"hello")
